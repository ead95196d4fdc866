// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/point_batch.h"

#include <algorithm>
#include <cmath>

#include "dice/opened_mesh.h"
#include "math/normalize_or.h"

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
        to_eye = normalize_or(-view, Vec3d(0.0, 0.0, -1.0));
        right = normalize_or(glm::cross(Vec3d(0.0, 1.0, 0.0), -to_eye), Vec3d(1.0, 0.0, 0.0));
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

Bounds3f PointBatch::box(int first, int end) const {
    Bounds3f box;
    for (int k = first; k < end; ++k) {
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
    return box;
}

RasterBounds PointBatch::bounds() const {
    return raster_bounds(box(0, m_elements->knot_count()));
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
        const int knots = m_elements->knot_count();
        const RasterBounds still = still_bounds(box(0, 1), box(knots - 1, knots));
        if (scattered(still))
            m_runs = runs_of(still);
        else
            m_diceable = rows * m_longitudes <= most;
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

std::vector<PointBatch::Row> PointBatch::rows() const {
    std::vector<Row> rows;
    for (std::size_t i = 0; i < m_count; ++i) {
        const int first = m_count == 1 ? m_part.v0 : 0;
        const int last = m_count == 1 ? m_part.v1 : m_latitudes[i];
        for (int latitude = first; latitude <= last; ++latitude)
            rows.push_back({element(m_first + i), latitude, m_latitudes[i]});
    }
    return rows;
}

std::unique_ptr<Grid> PointBatch::dice() const {
    const std::vector<Row> all = rows();
    auto grid = m_elements->make_grid(m_batch, m_path, static_cast<int>(all.size()) - 1,
                                      part().u1 - part().u0);
    for (std::size_t j = 0; j < all.size(); ++j) place_row(*grid, static_cast<int>(j), all[j]);
    finish(*grid);
    return grid;
}

std::shared_ptr<const ElementBatch> PointBatch::copy() const {
    return std::make_shared<PointBatch>(*this);
}

void PointBatch::fill_shading_state(Grid& grid) const {
    m_elements->begin_shading(grid);
    const std::vector<Row> all = rows();
    std::vector<ElementPlace> shading_positions;
    shading_positions.reserve(all.size());
    for (std::size_t j = 0; j < all.size(); ++j) {
        shade_row(grid, static_cast<int>(j), all[j]);
        shading_positions.push_back({all[j].point, all[j].point, all[j].point, 0.0});
    }
    m_elements->finish_shading(grid, shading_positions);
}

Vec2d PointBatch::lateral(const Row& row, int i, double out) const {
    const double u = M_PI * (static_cast<double>(part().u0 + i) / m_longitudes - 0.5);
    const double v = M_PI * (static_cast<double>(row.latitude) / row.latitudes - 0.5);
    const bool pole = row.latitude == 0 || row.latitude == row.latitudes;
    return {pole ? 0.0 : out * std::cos(v) * std::sin(u), out * std::sin(v)};
}

/// How far out the corners of the outline lie.
double PointBatch::Row::swell() const {
    const double corners = 2.0 * latitudes;
    return std::sqrt(2.0 * M_PI / (corners * std::sin(2.0 * M_PI / corners)));
}

void PointBatch::place_row(Grid& grid, int j, const Row& row) const {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    for (int k = 0; k < m_elements->knot_count(); ++k) {
        const Vertex sphere(*m_elements, m_elements->point(k, row.point));
        Vec3f* to = &grid.positions[static_cast<std::size_t>(k) * count];
        for (int i = 0; i <= grid.n_v; ++i) {
            const Vec2d at = lateral(row, i, row.swell());
            to[vertex(grid, i, j)] = Vec3f(sphere.at(at.x, at.y));
        }
    }
}

void PointBatch::shade_row(Grid& grid, int j, const Row& row) const {
    // Colours go linearly between vertices: normals are drawn in so far that the mean over the
    // outline is right for any quadratic (half of the area's radius where the sphere is flat).
    const double drawn_in =
        1.0 / std::sqrt(1.0 + 1.0 / (static_cast<double>(m_longitudes) * m_longitudes));
    const Vec3d towards(0.0, 0.0, -1.0);
    for (int i = 0; i <= grid.n_v; ++i) {
        const Vec2d on_sphere = lateral(row, i, 1.0), drawn = lateral(row, i, row.swell());
        Vec3d normal(0.0), geometric_normal(0.0), offset(0.0);
        for (int k = 0; k < m_elements->knot_count(); ++k) {
            const double weight = m_elements->frame_weight(k);
            if (weight == 0.0) continue;
            const Vertex sphere(*m_elements, m_elements->point(k, row.point));
            const Vec2d in = on_sphere * (drawn_in * sphere.sine);
            const double front = std::sqrt(std::max(1.0 - glm::dot(in, in), 0.0));
            const Vec3d here = sphere.right * in.x + sphere.up * in.y + sphere.to_eye * front;
            normal += here * weight;
            // Rays start on the sphere where it has this normal: they meet it only where that
            // turns away from them.
            offset += (here * sphere.radius - sphere.offset(drawn.x, drawn.y)) * weight;
            geometric_normal += here * weight;
        }
        const std::size_t at = vertex(grid, i, j);
        grid.normal[at] = Vec3f(normalize_or(normal, towards));
        grid.geometric_normal[at] = Vec3f(normalize_or(geometric_normal, towards));
        grid.ray_offset[at] = Vec3f(offset);
    }
}

}  // namespace granita
