// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/opened_elements.h"

#include <algorithm>
#include <cmath>

#include "dice/curve_batch.h"
#include "dice/grid_attributes.h"
#include "dice/motion_bounds.h"
#include "dice/point_batch.h"
#include "dice/triangle_grid.h"
#include "dice/visible_area.h"

namespace granita {

double uniform_scale(const Mat4d& m) {
    return std::cbrt(std::abs(glm::determinant(Mat3d(m))));
}

namespace {

/// A length of this matrix that none is larger than, by power iteration on m^T m.  Of close
/// singular values it finds one between, less than 1 % below the largest after 32 steps: what is
/// added.
double largest_stretch(const Mat3d& m) {
    Vec3d v(1.0, 0.0, 0.0);
    for (int i = 1; i < 3; ++i)
        if (glm::length(m[i]) > glm::length(m * v)) v = Vec3d(i == 0, i == 1, i == 2);
    for (int step = 0; step < 32; ++step) {
        const Vec3d next = glm::transpose(m) * (m * v);
        const double length = glm::length(next);
        if (!(length > 0.0)) return 0.0;
        v = next / length;
    }
    return 1.01 * glm::length(m * v);
}

}  // namespace

UnevenScale::UnevenScale(const Mat4d& m) : camera_from_object(m) {
    const double even = uniform_scale(m);
    for (int i = 0; i < 3; ++i) {
        const double length = glm::length(camera_from_object[i]);
        is_uneven |= std::abs(length - even) > 1e-4 * even;
    }
    if (even == 0.0) is_uneven = false;
    if (!is_uneven) return;
    object_from_camera = glm::inverse(camera_from_object);
    largest = largest_stretch(camera_from_object);
}

OpenedElements::OpenedElements(const View& view, std::size_t instance,
                               std::shared_ptr<const SharedElements> shared, Knots knots,
                               Report& report)
    : m_view(&view),
      m_instance(&view.scene->instances[instance]),
      m_instance_index(instance),
      m_shared(std::move(shared)),
      m_knots(std::move(knots)),
      m_report(&report),
      m_rate(view),
      m_long_rates{EdgeRate(view, 2.0), EdgeRate(view, 4.0)} {
    const int geometry_knots = m_shared->is_static() ? 1 : m_shared->data().knots;
    for (int k = 0; k < m_knots.count; ++k) {
        m_times.push_back(knot_time(k, m_knots.count - 1, geometry_knots));
        const Mat4d& m = m_knots.camera_from_object[static_cast<std::size_t>(k)];
        const bool is_curve = m_shared->data().kind == GeometryKind::Curves;
        m_uneven.emplace_back(is_curve ? m : Mat4d(1.0));
        m_scales.push_back(m_uneven.back().is_uneven ? m_uneven.back().largest : uniform_scale(m));
    }
}

const EdgeRate& OpenedElements::rate_along(double width) const {
    if (4.0 * width <= m_rate.rate()) return m_long_rates[1];
    return 2.0 * width <= m_rate.rate() ? m_long_rates[0] : m_rate;
}

RasterBounds OpenedElements::bounds(std::size_t primitive) const {
    return m_shared->data().kind == GeometryKind::Curves ? CurveBatch(*this, primitive).bounds()
                                                         : PointBatch(*this, primitive).bounds();
}

std::unique_ptr<Primitive> OpenedElements::primitive(std::size_t primitive) const {
    if (m_shared->data().kind == GeometryKind::Curves)
        return CurveBatch::open(shared_from_this(), primitive);
    return PointBatch::open(shared_from_this(), primitive);
}

ElementPoint OpenedElements::point(int knot, std::size_t vertex) const {
    const GeometryData& data = m_shared->data();
    const KnotTime& time = m_times[static_cast<std::size_t>(knot)];
    const std::size_t n = data.vertex_count(), at = time.knot * n + vertex;
    Vec3d p(data.points[at]);
    const bool one_radius = data.radius.size() == n;
    double radius = data.radius[one_radius ? vertex : at];
    if (time.fraction > 0.0) {
        p = p * (1.0 - time.fraction) + Vec3d(data.points[at + n]) * time.fraction;
        if (!one_radius)
            radius = radius * (1.0 - time.fraction) + data.radius[at + n] * time.fraction;
    }
    return {transform_point(m_knots.camera_from_object[static_cast<std::size_t>(knot)], p),
            std::max(radius, 0.0) * m_scales[static_cast<std::size_t>(knot)]};
}

double OpenedElements::pixels(const Vec3d& p, double length) const {
    const Projection& projection = m_view->projection;
    const double scale = std::max(projection.scale.x, projection.scale.y) * length;
    return projection.perspective ? scale / std::max({p.z, projection.near_clip, 1e-9}) : scale;
}

int OpenedElements::grid_size() const {
    return std::max(m_view->scene->options.grid_size, 1);
}

int OpenedElements::material(std::size_t batch) const {
    return m_instance->material(m_shared->slot(m_shared->batch(batch).front()));
}

std::unique_ptr<Grid> OpenedElements::make_grid(std::size_t batch, std::uint64_t path, int along,
                                                int across) const {
    auto grid = std::make_unique<Grid>();
    grid->key = {m_instance->key, static_cast<std::uint32_t>(batch), path};
    grid->instance = static_cast<std::uint32_t>(m_instance_index);
    grid->material = material(batch);
    grid->n_u = along;
    grid->n_v = across;
    grid->knots = m_knots.count;
    grid->holdout = m_view->scene->holds_out(*m_instance, grid->material);
    grid->lifespan = m_instance->lifespan;
    const std::size_t count = static_cast<std::size_t>(grid->vertex_count());
    grid->positions.resize(count * static_cast<std::size_t>(m_knots.count));
    return grid;
}

void OpenedElements::begin_shading(Grid& grid) const {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    set_frame_positions(grid, m_knots);
    for (auto* values : {&grid.normal, &grid.geometric_normal, &grid.ray_offset})
        values->resize(count);
}

void OpenedElements::finish_shading(Grid& grid, std::span<const ElementPlace> places) const {
    set_point_share(grid, visible_area(grid, grid.shading_p(), m_view->projection), m_rate.rate());
    finish_derivatives(grid, places);
    finish_attributes(grid, places);
}

void OpenedElements::finish_derivatives(Grid& grid, std::span<const ElementPlace> places) const {
    const std::vector<Vec3f>& p = grid.shading_p();
    grid.dp_du.resize(p.size());
    grid.dp_dv.resize(p.size());
    const auto row = static_cast<std::size_t>(grid.n_u) + 1;
    const auto joined = [&](int a, int b) {
        return b >= 0 && b <= grid.n_u &&
               places[static_cast<std::size_t>(a)].element ==
                   places[static_cast<std::size_t>(b)].element;
    };
    const auto at = [&](int i, int j) {
        return p[static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i)];
    };
    for (int j = 0; j <= grid.n_v; ++j) {
        const int low = std::max(j - 1, 0), high = std::min(j + 1, grid.n_v);
        for (int i = 0; i <= grid.n_u; ++i) {
            const int before = joined(i, i - 1) ? i - 1 : i, after = joined(i, i + 1) ? i + 1 : i;
            const std::size_t v = static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i);
            if (after > before)
                grid.dp_du[v] = (at(after, j) - at(before, j)) / static_cast<float>(after - before);
            grid.dp_dv[v] = (at(i, high) - at(i, low)) / static_cast<float>(high - low);
        }
    }
}

std::vector<float> OpenedElements::values_at(const AttributeRequest& request,
                                             std::span<const ElementPlace> places) const {
    const auto width = static_cast<std::size_t>(request.width);
    std::vector<float> values(places.size() * width);
    for (std::size_t i = 0; i < places.size(); ++i)
        element_value(*m_shared, request, places[i], &values[i * width]);
    return values;
}

void OpenedElements::finish_attributes(Grid& grid, std::span<const ElementPlace> places) const {
    const std::size_t lines = static_cast<std::size_t>(grid.n_v) + 1;
    const auto fill = [&](const AttributeRequest& request, GridAttribute& out) {
        const std::size_t width = static_cast<std::size_t>(out.width);
        // The same in each line along the elements.
        const std::size_t line = places.size() * width;
        const auto repeat = [&](std::vector<float>& values) {
            values.reserve(lines * line);
            for (std::size_t j = 1; j < lines; ++j)
                values.insert(values.end(), values.begin(),
                              values.begin() + static_cast<std::ptrdiff_t>(line));
        };
        out.values = values_at(request, places);
        if (request.derivatives) {
            out.du.assign(line, 0.0f);
            for (std::size_t i = 0; i + 1 < places.size(); ++i)
                for (std::size_t c = i * width; c < (i + 1) * width; ++c)
                    if (places[i].element == places[i + 1].element)
                        out.du[c] = out.values[c + width] - out.values[c];
            repeat(out.du);
            out.dv.assign(lines * line, 0.0f);
        }
        repeat(out.values);
    };
    make_attributes(grid, m_view->requests_of(grid.material), fill);
}

void OpenedElements::fill_attributes(Grid& grid, std::span<const ElementPlace> places,
                                     std::span<const ElementPlace> next) const {
    const auto fill = [&](const AttributeRequest& request, GridAttribute& out) {
        const std::vector<float> values = values_at(request, places);
        repeat_runs(values, out.values);
        if (!request.derivatives) return;
        std::vector<float> steps = values_at(request, next);
        for (std::size_t c = 0; c < steps.size(); ++c) steps[c] -= values[c];
        repeat_runs(steps, out.du);
        out.dv.assign(out.du.size(), 0.0f);
    };
    make_attributes(grid, m_view->requests_of(grid.material), fill);
}

}  // namespace granita
