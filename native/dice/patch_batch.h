// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of a few pixels as one grid of separate micropolygons (Grid::disjoint): the micropolygons
// that their patches dice into, with the same vertices, shaded at the same points.  A sphere whose
// faces are 3 pixels wide so takes a tenth of the grids, and what a grid costs by itself (a node,
// bounds in time, projection and sorting in each tile) is paid a tenth as often.
#pragma once

#include "dice/face_batch.h"

namespace granita {

class PatchBatch final : public FaceBatch {
  public:
    using FaceBatch::FaceBatch;
    std::unique_ptr<Grid> dice() const override;

  private:
    /// A face that is a lattice by its sides alone.
    struct Lattice {
        BasePatch patch;
        std::uint32_t stencil;
    };
    /// A part of another one, as its patch diced it.
    struct Piece {
        std::uint32_t face;
        std::shared_ptr<const Grid> grid;
    };
    /// All of the batch, in the order in which the grid has it: lattices, then pieces.
    struct Parts {
        std::vector<Lattice> lattices;
        std::vector<Piece> pieces;
    };
    Parts find_parts() const;
    bool find_stencil(const BasePatch& patch, std::uint32_t& stencil) const;
    int levels(std::uint32_t a, std::uint32_t b, const BasePatch& face) const;
    void dice_face(const BasePatch& patch, std::vector<Piece>& pieces) const;
    void place(Grid& grid, const Parts& parts) const;
    RasterBounds corner_bounds() const;
    void count_spared(const Grid& grid, const Parts& parts) const;
    void fill_shading_state(Grid& grid, const Parts& parts) const;
    void add_points(const Lattice& lattice, Grid& grid) const;
    void fill_attributes(Grid& grid, const Parts& parts) const;
};

}  // namespace granita
