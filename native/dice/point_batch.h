// SPDX-License-Identifier: GPL-3.0-or-later
// Points as spheres, many to a primitive: of each the half that the eye sees, as a grid of
// latitudes (v) and longitudes (u) whose outline is the sphere's, at every knot.  Its poles lie on
// the outline, and the row there is a point: micropolygons from one pole to the next sphere's have
// no area, the hider leaves them out.  A sphere of a pixel is a flat polygon of its area.
#pragma once

#include <memory>
#include <vector>

#include "dice/element_batch.h"

namespace granita {

class PointBatch final : public ElementBatch {
  public:
    /// Whole batch; bounds alone may be asked of it.
    PointBatch(const OpenedElements& elements, std::size_t batch);
    static std::unique_ptr<PointBatch> open(std::shared_ptr<const OpenedElements> elements,
                                            std::size_t batch);

    RasterBounds bounds() const override;
    std::unique_ptr<Grid> dice() const override;

  protected:
    std::unique_ptr<ElementBatch> child() const override;
    void halve(unsigned number) override;
    void measure() override;

  private:
    /// Latitudes and longitudes of a half sphere, powers of two.
    struct Rates {
        int v = 0, u = 0;
    };
    /// Steps [v0, v1] x [u0, u1] of a single sphere.
    struct Part {
        int v0 = 0, v1 = 0, u0 = 0, u1 = 0;
    };
    struct Vertex;

    Rates rates(std::uint32_t point) const;
    void fill_row(Grid& grid, int j, std::uint32_t point, int latitude, int latitudes,
                  const Part& part) const;

    Part m_part;                   ///< of a single point
    std::vector<int> m_latitudes;  ///< [m_count]
    int m_longitudes = 1;
};

}  // namespace granita
