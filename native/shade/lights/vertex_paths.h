// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "dice/grid.h"
#include "scene/scene.h"

namespace granita {

/// Where the vertices of a grid are over the shutter, in shading space, as rays see it: linear
/// between equidistant knots, but for what deforms and turns at once.  The camera's own motion
/// moves nothing in the world.
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
    bool is_bent() const { return !m_turns.empty(); }
    /// Rays meet a shape that is linear in object space, carried by a transform that is linear: of
    /// a way from `before`, at the knot, to `after`, at the next, what the product of both takes
    /// off the straight line.  Times f (1 - f) of the fraction between the knots.
    Vec3f bend(std::size_t knot, const Vec3f& before, const Vec3f& after) const;

  private:
    void add_turns(const Instance& instance, const Vec3d& origin);

    const Grid& m_grid;
    float m_frame_time;
    Mat3f m_frame_rotation;
    /// The camera at a knot, from camera to shading space.
    struct Place {
        Mat3f rotation;
        Vec3f offset;
    };
    std::vector<Place> m_cameras;  ///< [knots]; one where nothing moves
    /// The instance at a knot.
    struct Turn {
        Mat3d axes;
        Mat4d object_from_shading;
    };
    std::vector<Turn> m_turns;  ///< [knots]; empty where ways are straight
};

}  // namespace granita
