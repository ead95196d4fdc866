// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "dice/grid.h"
#include "scene/scene.h"
#include "shade/lobe.h"

namespace granita {

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
    Vec3f position(std::size_t point, float time) const { return at(m_positions, point, time); }
    /// From the position to where rays may start (Grid::ray_offset).
    Vec3f ray_offset(std::size_t point, float time) const {
        return m_offsets.empty() ? Vec3f(0.0f) : at(m_offsets, point, time);
    }
    /// Unit geometric normal on the side that the viewer sees at the frame time.
    Vec3f normal(std::size_t point, float time) const;

  private:
    Vec3f at(const std::vector<Vec3f>& values, std::size_t point, float time) const;

    Lifespan m_lifespan;
    int m_knots = 1;
    std::size_t m_count = 0;
    std::vector<Vec3f> m_positions, m_normals;  ///< [knots][points]
    std::vector<Vec3f> m_offsets;               ///< [knots][points]; empty: none
};

}  // namespace granita
