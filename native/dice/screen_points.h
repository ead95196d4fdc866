// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "dice/opened_mesh.h"

namespace granita {

/// An opened mesh's vertices as the camera sees them; not a number where it does not.
class ScreenPoints {
  public:
    explicit ScreenPoints(const OpenedMesh& mesh)
        : m_projection(mesh.view().projection),
          m_width(static_cast<float>(mesh.view().scene->options.width)),
          m_height(static_cast<float>(mesh.view().scene->options.height)),
          m_reach(mesh.displacement_reach()),
          m_swept(mesh.part().vertex_count()) {}

    void project(std::span<const Vec3f> points) {
        const float near = static_cast<float>(m_projection.near_clip);
        const Vec2f scale(m_projection.scale), center(m_projection.center);
        m_points.resize(points.size());
        for (std::size_t v = 0; v < points.size(); ++v) {
            const Vec3f& p = points[v];
            const bool ahead = !m_projection.perspective || p.z > near;
            const float w = m_projection.perspective ? 1.0f / p.z : 1.0f;
            m_points[v] = ahead ? center + scale * Vec2f(p) * w
                                : Vec2f(std::numeric_limits<float>::quiet_NaN());
            const Vec2f margin(m_reach > 0.0f ? moved(m_points[v], p.z) : 0.0f);
            m_swept[v].lo = glm::min(m_swept[v].lo, m_points[v] - margin);
            m_swept[v].hi = glm::max(m_swept[v].hi, m_points[v] + margin);
        }
    }
    const Vec2f& operator[](std::size_t v) const { return m_points[v]; }
    /// Whether the vertex may have been in the frame, over all knots so far, or may have been moved
    /// there by displacement.
    bool met_frame(std::size_t v) const {
        const Swept& s = m_swept[v];
        return s.lo.x <= m_width && s.hi.x >= 0.0f && s.lo.y <= m_height && s.hi.y >= 0.0f;
    }
    /// Pixels from the eye, so that a step in depth is as long as one across.
    float depth(float z) const {
        const float scale = static_cast<float>(m_projection.scale.x);
        return scale * (m_projection.perspective ? std::log(z) : z);
    }

  private:
    struct Swept {
        Vec2f lo{INFINITY}, hi{-INFINITY};
    };
    /// How far displacement may move a vertex of this depth in the raster, where it is `there`.
    float moved(const Vec2f& there, float z) const {
        const float scale =
            static_cast<float>(std::max(m_projection.scale.x, m_projection.scale.y));
        if (!m_projection.perspective) return scale * m_reach;
        const float left = z - m_reach;
        return left > 0.0f
                   ? (scale + glm::distance(there, Vec2f(m_projection.center))) * m_reach / left
                   : std::numeric_limits<float>::infinity();
    }

    const Projection m_projection;
    const float m_width, m_height;
    const float m_reach;  ///< metres
    std::vector<Vec2f> m_points;
    std::vector<Swept> m_swept;
};

}  // namespace granita
