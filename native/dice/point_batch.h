// SPDX-License-Identifier: GPL-3.0-or-later
// Points as spheres, many to a primitive: of each the half that the eye sees, as a grid of
// latitudes (v) and longitudes (u) whose outline is the sphere's, at every knot.  Its poles lie on
// the outline, and the row there is a point: micropolygons from one pole to the next sphere's have
// no area, the hider leaves them out.  A sphere of a pixel is a flat polygon of its area.
#pragma once

#include <memory>
#include <vector>

#include "dice/opened_elements.h"

namespace granita {

class PointBatch final : public Primitive {
  public:
    /// Whole batch; bounds alone may be asked of it.
    PointBatch(const OpenedElements& elements, std::size_t batch);
    static std::unique_ptr<PointBatch> open(std::shared_ptr<const OpenedElements> elements,
                                            std::size_t batch);

    RasterBounds bounds() const override;
    GridKey key() const override;
    bool diceable() const override { return m_diceable; }
    std::vector<std::unique_ptr<Primitive>> split() const override;
    std::unique_ptr<Grid> dice() const override;

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

    void measure();
    Rates rates(std::uint32_t point) const;
    std::uint32_t point(std::size_t i) const { return m_elements->shared().batch(m_batch)[i]; }
    void fill_row(Grid& grid, int j, std::uint32_t point, int latitude, int latitudes,
                  const Part& part) const;

    const OpenedElements* m_elements;
    std::shared_ptr<const OpenedElements> m_owner;  ///< keeps m_elements
    std::size_t m_batch;
    std::uint64_t m_path = 1;
    std::size_t m_first = 0, m_count = 0;  ///< points of the batch
    Part m_part;                           ///< of a single point
    std::vector<int> m_latitudes;          ///< [m_count]
    int m_longitudes = 1;
    bool m_diceable = false;
};

}  // namespace granita
