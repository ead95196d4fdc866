// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "dice/grid.h"
#include "scene/scene.h"

namespace granita {

/// Where the vertices of a grid are over the shutter, in shading space: linear between equidistant
/// knots, as rays see it.  The camera's own motion moves nothing in the world.
class VertexPaths {
  public:
    /// The grid outlives this.
    VertexPaths(const Grid& grid, const Scene& scene);

    /// False: all places are at_frame().
    bool moves() const { return m_cameras.size() > 1; }
    std::size_t knots() const { return m_cameras.size(); }
    Vec3f at_frame(std::size_t vertex) const;
    Vec3f at_knot(std::size_t vertex, std::size_t knot) const;
    Vec3f at(std::size_t vertex, float time) const;

  private:
    const Grid& m_grid;
    float m_frame_time;
    Mat3f m_frame_rotation;
    /// The camera at a knot, from camera to shading space.
    struct Place {
        Mat3f rotation;
        Vec3f offset;
    };
    std::vector<Place> m_cameras;  ///< [knots]; one where nothing moves
};

}  // namespace granita
