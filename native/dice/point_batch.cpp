// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/point_batch.h"

#include <algorithm>
#include <cmath>

#include "dice/opened_mesh.h"

namespace granita {
namespace {

/// An outline stays this close to the circle, pixels.
constexpr double kSag = 0.1;
/// Below this radius, pixels, a square of the circle's area does.
constexpr double kTiny = 0.25;
constexpr int kMostSteps = 1024;
/// The outline's corners lie outside the circle so that their polygon has its area: a square's by
/// sqrt(pi / 2).
constexpr double kReach = 1.2534;

int steps_for(double steps, int least) {
    int n = least;
    while (n < steps && n < kMostSteps) n *= 2;
    return n;
}

}  // namespace

/// A sphere's half as the eye sees it: a circle around `middle` across the view, bulging to the
/// eye.
struct PointBatch::Vertex {
    Vertex(const OpenedElements& elements, const ElementPoint& sphere) : center(sphere.p) {
        const Vec3d view = elements.view_direction(sphere.p);
        to_eye = unit_or(-view, Vec3d(0.0, 0.0, -1.0));
        right = unit_or(glm::cross(Vec3d(0.0, 1.0, 0.0), -to_eye), Vec3d(1.0, 0.0, 0.0));
        up = glm::cross(-to_eye, right);
        radius = sphere.radius;
        outline = radius;
        if (!elements.view().projection.perspective) return;
        // The cone from the eye touches the sphere in front of its middle; from inside nothing
        // is seen of it.
        const double angle = radius / std::max(glm::length(sphere.p), 1e-300);
        sine = std::sqrt(std::max(1.0 - angle * angle, 0.0));
        outline = radius * sine;
    }
    /// `x`, `y`: of the outline's radius.
    Vec3d at(double x, double y) const { return center + offset(x, y); }
    Vec3d offset(double x, double y) const {
        const double across = outline * outline * (x * x + y * y);
        const double height =
            outline > 0.0 ? std::sqrt(std::max(radius * radius - across, 0.0)) : 0;
        return (right * x + up * y) * outline + to_eye * height;
    }
    Vec3d center, to_eye, right, up;
    double radius, outline;
    double sine = 1.0;  ///< of the outline's normals against the way to the eye
};

PointBatch::PointBatch(const OpenedElements& elements, std::size_t batch)
    : ElementBatch(elements, batch) {}

std::unique_ptr<PointBatch> PointBatch::open(std::shared_ptr<const OpenedElements> elements,
                                             std::size_t batch) {
    auto opened = std::make_unique<PointBatch>(*elements, batch);
    opened->own(std::move(elements));
    return opened;
}

RasterBounds PointBatch::bounds() const {
    Bounds3f box;
    for (int k = 0; k < m_elements->knot_count(); ++k) {
        if (m_part.v1 > 0) {
            // A part lies between its corners; how far it bulges out of their box is bounded by
            // the sagitta of its steps' arcs.
            const Vertex sphere(*m_elements, m_elements->point(k, element(m_first)));
            const int v = m_latitudes[0], u = m_longitudes;
            const double arc = M_PI * std::max(static_cast<double>(m_part.v1 - m_part.v0) / v,
                                               static_cast<double>(m_part.u1 - m_part.u0) / u);
            Bounds3f part;
            for (const int j : {m_part.v0, m_part.v1})
                for (const int i : {m_part.u0, m_part.u1}) {
                    const double latitude = M_PI * (static_cast<double>(j) / v - 0.5);
                    const double longitude = M_PI * (static_cast<double>(i) / u - 0.5);
                    part.add(Vec3f(
                        sphere.at(std::cos(latitude) * std::sin(longitude), std::sin(latitude))));
                }
            part.grow(static_cast<float>(sphere.radius * std::min(arc, 2.0)));
            box.add(part);
            continue;
        }
        for (std::size_t i = m_first; i < m_first + m_count; ++i) {
            const ElementPoint sphere = m_elements->point(k, element(i));
            const Vec3d reach(kReach * sphere.radius);
            box.add(Vec3f(sphere.p - reach));
            box.add(Vec3f(sphere.p + reach));
        }
    }
    return raster_bounds(box);
}

PointBatch::Rates PointBatch::rates(std::uint32_t point) const {
    double radius = 0.0;
    for (int k = 0; k < m_elements->knot_count(); ++k) {
        const ElementPoint sphere = m_elements->point(k, point);
        radius = std::max(radius, m_elements->pixels(sphere.p, sphere.radius));
    }
    if (radius <= kTiny) return {2, 1};
    const double target = M_SQRT2 * m_elements->rate().rate();
    const double steps = M_PI * radius / target;
    return {steps_for(std::max(steps, 0.5 * M_PI * std::sqrt(0.5 * radius / kSag)), 4),
            2.0 * radius <= target ? 1 : steps_for(steps, 2)};
}

void PointBatch::measure() {
    const int most = m_elements->grid_size();
    int rows = -1;  // each sphere's and one to the next
    m_latitudes.clear();
    m_longitudes = 1;
    for (std::size_t i = m_first; i < m_first + m_count; ++i) {
        const Rates needed = rates(element(i));
        m_latitudes.push_back(needed.v);
        m_longitudes = std::max(m_longitudes, needed.u);
        rows += needed.v + 1;
    }
    if (m_count > 1) {
        m_diceable = rows * m_longitudes <= most && !scattered();
        return;
    }
    if (m_part.v1 == 0) m_part = {0, m_latitudes[0], 0, m_longitudes};
    const int v = m_part.v1 - m_part.v0, u = m_part.u1 - m_part.u0;
    m_diceable = v * u <= most || v * u == 1;
}

std::unique_ptr<ElementBatch> PointBatch::child() const {
    auto child = std::make_unique<PointBatch>(*m_elements, m_batch);
    child->m_owner = m_owner;
    child->m_first = m_first;
    child->m_count = m_count;
    child->m_part = m_part;
    return child;
}

void PointBatch::halve(unsigned number) {
    if (m_part.v1 - m_part.v0 >= m_part.u1 - m_part.u0)
        (number == 0 ? m_part.v1 : m_part.v0) = (m_part.v0 + m_part.v1) / 2;
    else
        (number == 0 ? m_part.u1 : m_part.u0) = (m_part.u0 + m_part.u1) / 2;
}

std::unique_ptr<Grid> PointBatch::dice() const {
    const Part part = m_count == 1 ? m_part : Part{0, 0, 0, m_longitudes};
    int rows = 0;
    for (const int latitudes : m_latitudes)
        rows += (m_count == 1 ? part.v1 - part.v0 : latitudes) + 1;
    auto grid = m_elements->make_grid(m_batch, m_path, part.u1 - part.u0, rows - 1);
    std::vector<ElementPlace> places;
    places.reserve(static_cast<std::size_t>(rows));
    for (std::size_t i = 0; i < m_count; ++i) {
        const std::uint32_t p = element(m_first + i);
        const int first = m_count == 1 ? part.v0 : 0;
        const int last = m_count == 1 ? part.v1 : m_latitudes[i];
        for (int latitude = first; latitude <= last; ++latitude) {
            fill_row(*grid, static_cast<int>(places.size()), p, latitude, m_latitudes[i], part);
            places.push_back({p, p, p, 0.0});
        }
    }
    m_elements->finish(*grid, places);
    return grid;
}

void PointBatch::fill_row(Grid& grid, int j, std::uint32_t point, int latitude, int latitudes,
                          const Part& part) const {
    const Knots& knots = m_elements->knots();
    const std::size_t count = static_cast<std::size_t>(grid.vertex_count());
    const std::size_t first = static_cast<std::size_t>(j * (grid.n_u + 1));
    const double corners = 2.0 * latitudes;
    const double swell = std::sqrt(2.0 * M_PI / (corners * std::sin(2.0 * M_PI / corners)));
    const double v = M_PI * (static_cast<double>(latitude) / latitudes - 0.5);
    const bool pole = latitude == 0 || latitude == latitudes;
    const bool flat = m_longitudes == 1;
    // Colours go linearly between vertices: normals are drawn in so far that the mean over the
    // outline is right for any quadratic (half of the area's radius where the sphere is flat).
    const double drawn_in =
        1.0 / std::sqrt(1.0 + 1.0 / (static_cast<double>(m_longitudes) * m_longitudes));
    for (int k = 0; k < knots.count; ++k) {
        const Vertex sphere(*m_elements, m_elements->point(k, point));
        const double weight = k == knots.frame_knot       ? 1.0 - knots.frame_fraction
                              : k == knots.frame_knot + 1 ? knots.frame_fraction
                                                          : 0.0;
        for (int i = 0; i <= grid.n_u; ++i) {
            const double u = M_PI * (static_cast<double>(part.u0 + i) / m_longitudes - 0.5);
            const double x = pole ? 0.0 : swell * std::cos(v) * std::sin(u);
            const double y = swell * std::sin(v);
            const std::size_t vertex = first + static_cast<std::size_t>(i);
            grid.positions[static_cast<std::size_t>(k) * count + vertex] = Vec3f(sphere.at(x, y));
            if (weight == 0.0) continue;
            const Vec2d lateral(pole ? 0.0 : std::cos(v) * std::sin(u), std::sin(v));
            const Vec2d in = lateral * (drawn_in * sphere.sine);
            const double front = std::sqrt(std::max(1.0 - glm::dot(in, in), 0.0));
            const Vec3d normal = sphere.right * in.x + sphere.up * in.y + sphere.to_eye * front;
            grid.normal[vertex] += Vec3f(normal * weight);
            // Rays start on the sphere where it has this normal: they meet it only where that
            // turns away from them.
            grid.ray_offset[vertex] +=
                Vec3f((normal * sphere.radius - sphere.offset(x, y)) * weight);
            const Vec3d surface = flat ? sphere.to_eye : sphere.offset(lateral.x, lateral.y);
            grid.geometric_normal[vertex] += Vec3f(unit_or(surface, sphere.to_eye) * weight);
        }
    }
    for (int i = 0; i <= grid.n_u; ++i) {
        const std::size_t vertex = first + static_cast<std::size_t>(i);
        const Vec3d up(0.0, 0.0, -1.0);
        grid.normal[vertex] = Vec3f(unit_or(Vec3d(grid.normal[vertex]), up));
        grid.geometric_normal[vertex] = Vec3f(unit_or(Vec3d(grid.geometric_normal[vertex]), up));
    }
}

}  // namespace granita
