// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of a few pixels as one grid of separate micropolygons (Grid::apart): the micropolygons that
// their patches dice into, with the same vertices, shaded at the same points.  A sphere whose faces
// are 3 pixels wide so takes a tenth of the grids, and what a grid costs by itself (a node, bounds
// in time, projection and sorting in each tile) is paid a tenth as often.
#pragma once

#include "dice/face_batch.h"

namespace granita {

class PatchBatch final : public FaceBatch {
  public:
    using FaceBatch::FaceBatch;
    std::unique_ptr<Grid> dice() const override;

  private:
    struct Part;
    bool is_lattice(Part& part, bool inside) const;
    void dice_face(std::size_t face, std::vector<Part>& parts) const;
};

}  // namespace granita
