// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "dice/grid.h"
#include "math/bounds.h"
#include "scene/scene.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// One of some times, by a number in [0, 1).
inline float one_of(std::span<const float> times, float uniform) {
    const auto count = static_cast<float>(times.size());
    return times[static_cast<std::size_t>(uniform * count) % times.size()];
}

/// Where the points of a grid are over the shutter, for light that changes within it: world axes,
/// origin at the camera of the frame time, linear between equidistant knots.  The camera's own
/// motion moves nothing in the world.
class PointPaths {
  public:
    /// Points that stand still.
    PointPaths() = default;
    /// `points`: shading_points() of the grid.
    PointPaths(const Grid& grid, const Scene& scene, const ShadingPoints& points);

    bool moves() const { return m_knots > 1; }
    const Lifespan& lifespan() const { return m_lifespan; }
    struct Place {
        Vec3f p;
        Vec3f start;   ///< where rays may, as far as the grid knows (Grid::ray_offset)
        Vec3f normal;  ///< unit, geometric, on the side that the viewer sees at the frame time
    };
    Place at(std::size_t point, float time) const;
    /// Box around the point's places; empty of points that stand still.
    Bounds3f reach(std::size_t point) const;

  private:
    void rise(const Grid& grid, const std::vector<Vec3f>& places, std::size_t first);

    Lifespan m_lifespan;
    int m_knots = 1;
    std::size_t m_count = 0;
    std::vector<Place> m_places;  ///< [knots][points]
    std::vector<Vec3f> m_bends;   ///< [knots - 1][points], VertexPaths::bend(); empty: straight
};

}  // namespace granita
