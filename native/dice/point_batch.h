// SPDX-License-Identifier: GPL-3.0-or-later
// Points as spheres, many to a primitive: of each the half that the eye sees, as a grid of
// latitudes (along) and longitudes (across) whose outline is the sphere's, at every knot.  Its
// poles lie on the outline, and the row there is a point: micropolygons from one pole to the next
// sphere's have no area, the hider leaves them out.  A sphere of a pixel is a flat polygon of its
// area.
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
    std::shared_ptr<const ElementBatch> copy() const override;
    void fill_shading_state(Grid& grid) const override;

  private:
    /// Over the knots from `first` to before `end`.
    Bounds3f box(int first, int end) const;
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
    /// One of a sphere's rows.
    struct Row {
        std::uint32_t point = 0;
        int latitude = 0, latitudes = 0;
        double swell() const;
    };
    std::vector<Row> rows() const;
    Part part() const { return m_count == 1 ? m_part : Part{0, 0, 0, m_longitudes}; }
    /// Place (x, y) of a vertex on the outline's disc; `out` is drawn out to the circle's area.
    Vec2d lateral(const Row& row, int i, double out) const;
    void place_row(Grid& grid, int j, const Row& row) const;
    void shade_row(Grid& grid, int j, const Row& row) const;

    Part m_part;                   ///< of a single point
    std::vector<int> m_latitudes;  ///< [m_count]
    int m_longitudes = 1;
};

}  // namespace granita
