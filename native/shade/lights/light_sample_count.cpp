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

/// Samples a pixel whose error at edges is that of all light samples.
constexpr double kEdgeSamples = 650.0;
/// Of the variance of a point, what a pixel of a mesh may have: faces of a pixel keep all samples.
constexpr double kDense = 4.0;
/// One light sample is in no doubt that could be told.  Of a share that is rounded by up to the
/// root of two (LampSet::sample_count) two are left.
constexpr float kLeastSamples = 2.8f;
/// Pixels across from which ribbons are surfaces.
constexpr double kWide = 8.0;

/// Of a sharp mean's variance, with a blur of `length` pixels one way.
double share_along(double length) {
    const double ratio = length / kSquare;
    return ratio < 1.0 ? 1.0 - ratio / 3.0 : (1.0 - 1.0 / (3.0 * ratio)) / ratio;
}

class GridOnFilm {
  public:
    GridOnFilm(const Grid& grid, const Projection& projection)
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
        const double sum = area_at({});
        return std::isfinite(sum) ? std::max(1.0, sum / static_cast<double>(m_grid.point_count()))
                                  : 1.0;
    }
    /// Square pixels of all micropolygons, at that end or middle of the shutter at which these are
    /// most; infinite where one is not before the camera.
    double most_area() const {
        double most = area_at({});
        if (m_grid.knots == 1) return most;
        for (const double time : {0.5, 1.0})
            most = std::max(most, area_at(knot_time(time, m_grid.knots)));
        return most;
    }
    /// Pixels across, ribbons along u: their area over their length.
    double width() const {
        double area = 0.0, length = 0.0;
        const auto add = [&](const Corners& corner) {
            const double here = area_of(corner);
            if (!(here > 0.0)) return;  // between two of them
            area += here;
            length +=
                0.5 * (glm::distance(corner[0], corner[1]) + glm::distance(corner[2], corner[3]));
        };
        if (!visit({}, add)) return kWide;
        return length > 0.0 ? area / length * m_grid.n_v : 0.0;
    }

  private:
    using Corners = Vec2d[4];

    static double area_of(const Corners& corner) {
        const Vec2d across = corner[2] - corner[0], up = corner[3] - corner[1];
        return 0.5 * std::abs(across.x * up.y - across.y * up.x);
    }
    /// Infinite where one is not before the camera.
    double area_at(const KnotTime& then) const {
        double sum = 0.0;
        const bool all = visit(then, [&](const Corners& corner) { sum += area_of(corner); });
        return all ? sum : std::numeric_limits<double>::infinity();
    }
    /// of(corners) for each micropolygon at a time, until one is not before the camera: false.
    template <class Of>
    bool visit(const KnotTime& then, const Of& of) const {
        for (int m = 0; m < m_grid.micropolygon_count(); ++m) {
            const Grid::Corners c = m_grid.corners(m);
            Corners corner;
            if (!place(c.v0, then, corner[0]) || !place(c.v1, then, corner[1]) ||
                !place(c.v2, then, corner[2]) || !place(c.v3, then, corner[3]))
                return false;
            of(corner);
        }
        return true;
    }
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
    const GridOnFilm blur(grid, projection);
    const double way = blur.way(shutter) * static_cast<double>(scene.options.row_exposure());
    const double side = projection.has_lens() ? std::sqrt(M_PI_4) * blur.circle() : 0.0;
    if (!(way + side > 0.0)) return 1.0f;
    const double share = share_along(std::hypot(way, side)) * share_along(side);
    const double variance = share * blur.area() + 1.0 / scene.options.samples;
    return static_cast<float>(std::sqrt(std::min(1.0, variance)));
}

float edge_light_fraction(int samples) {
    return static_cast<float>(std::min(1.0, std::pow(samples / kEdgeSamples, 0.75)));
}

float edge_light_sample_count(const Grid& grid, const Scene& scene) {
    const GeometryKind kind = scene.geometry_of(scene.instances[grid.instance]).kind;
    if (kind != GeometryKind::Curves && kind != GeometryKind::Points) return 1.0f;
    const double wide = GridOnFilm(grid, scene.camera.projection).width() / kWide;
    return std::max(edge_light_fraction(scene.options.samples),
                    static_cast<float>(std::min(1.0, wide * wide)));
}

float dense_light_fraction(const Grid& grid, const Scene& scene) {
    const GeometryKind kind = scene.geometry_of(scene.instances[grid.instance]).kind;
    if (kind != GeometryKind::Mesh || grid.shades_faces()) return 1.0f;
    const double area = GridOnFilm(grid, scene.camera.projection).most_area();
    const double of_one = area / static_cast<double>(grid.point_count());
    // Those of a finer dicing rate are wanted.
    const double rate = std::min(1.0f, scene.options.dicing_rate);
    const double variance = kDense * (of_one / (rate * rate) + 1.0 / scene.options.samples);
    if (!(variance < 1.0)) return 1.0f;
    return std::min(1.0f,
                    std::max(static_cast<float>(std::sqrt(variance)),
                             kLeastSamples / static_cast<float>(scene.options.light_samples)));
}

float light_sample_step(float count) {
    return std::exp2(std::round(4.0f * std::log2(count)) / 4.0f);
}

}  // namespace granita
