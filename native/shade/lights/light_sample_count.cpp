// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_sample_count.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/least_circle.h"
#include "scene/knot_time.h"

namespace granita {
namespace {

/// Side of the square whose mean keeps its noise, pixels.
constexpr double kSquare = 4.0;

/// Of a sharp mean's variance, with a blur of `length` pixels one way.
double share_along(double length) {
    const double ratio = length / kSquare;
    return ratio < 1.0 ? 1.0 - ratio / 3.0 : (1.0 - 1.0 / (3.0 * ratio)) / ratio;
}

class GridBlur {
  public:
    GridBlur(const Grid& grid, const Projection& projection)
        : m_grid(grid), m_projection(projection) {}

    /// The shortest way of a vertex, pixels: twice that in the middle half of the exposure, which
    /// is all of it where speed and shutter are even, and less than what blurs where not.
    double way(const ShutterWarp& shutter) const {
        if (!m_grid.motion || !m_grid.lifespan.is_whole()) return 0.0;
        const KnotTime early = knot_time(shutter.time(0.25f), m_grid.knots);
        const KnotTime late = knot_time(shutter.time(0.75f), m_grid.knots);
        double shortest = std::numeric_limits<double>::infinity();
        for (int v = 0; v < m_grid.vertex_count(); ++v) {
            Vec2d from, to;
            if (!place(v, early, from) || !place(v, late, to)) return 0.0;
            shortest = std::min(shortest, 2.0 * glm::distance(from, to));
        }
        return std::isfinite(shortest) ? shortest : 0.0;
    }
    double circle() const {
        LeastCircle circle(m_projection);
        for (const Vec3f& p : m_grid.positions) circle.add(p.z);
        return circle.diameter();
    }
    /// Square pixels that a point stands for, at least 1.
    double area() const {
        if (m_grid.disjoint) return 1.0;
        const KnotTime first;
        double sum = 0.0;
        for (int m = 0; m < m_grid.micropolygon_count(); ++m) {
            const Grid::Corners c = m_grid.corners(m);
            Vec2d a, b, d, e;
            if (!place(c.v0, first, a) || !place(c.v1, first, b) || !place(c.v2, first, d) ||
                !place(c.v3, first, e))
                return 1.0;
            const Vec2d across = d - a, up = e - b;
            sum += 0.5 * std::abs(across.x * up.y - across.y * up.x);
        }
        return std::max(1.0, sum / static_cast<double>(m_grid.point_count()));
    }

  private:
    /// False where it is not before the camera.
    bool place(int vertex, const KnotTime& time, Vec2d& out) const {
        const auto count = static_cast<std::size_t>(m_grid.vertex_count());
        const auto at = time.knot * count + static_cast<std::size_t>(vertex);
        Vec3d p(m_grid.positions[at]);
        if (time.fraction > 0.0)
            p = glm::mix(p, Vec3d(m_grid.positions[at + count]), time.fraction);
        if (m_projection.perspective && !(p.z > 0.0)) return false;
        out = m_projection.scale * Vec2d(p) / (m_projection.perspective ? p.z : 1.0);
        return true;
    }

    const Grid& m_grid;
    const Projection& m_projection;
};

}  // namespace

float light_sample_count(const Grid& grid, const Scene& scene, const ShutterWarp& shutter) {
    const Projection& projection = scene.camera.projection;
    const GridBlur blur(grid, projection);
    const double way = blur.way(shutter) * static_cast<double>(scene.options.row_exposure());
    const double side = projection.has_lens() ? std::sqrt(M_PI_4) * blur.circle() : 0.0;
    if (!(way + side > 0.0)) return 1.0f;
    const double share = share_along(std::hypot(way, side)) * share_along(side);
    const double variance = share * blur.area() + 1.0 / scene.options.samples;
    return static_cast<float>(std::sqrt(std::min(1.0, variance)));
}

float light_sample_step(float count) {
    return std::exp2(std::round(4.0f * std::log2(count)) / 4.0f);
}

}  // namespace granita
