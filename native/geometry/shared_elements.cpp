// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/shared_elements.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "math/morton.h"

namespace granita {
namespace {

/// Control points of a batch: about a grid's worth of micropolygons for short hairs.
constexpr std::size_t kBatchPoints = 128;
constexpr std::size_t kMostElements = 32;

/// 21 bits a coordinate of the box.
std::uint64_t place_code(const Bounds3f& box, const Vec3d& p) {
    Vec3f cell(0.0f);
    for (int i = 0; i < 3; ++i) {
        const double size = static_cast<double>(box.hi[i]) - box.lo[i];
        if (size > 0.0) cell[i] = static_cast<float>((p[i] - box.lo[i]) / size * 0x1fffff);
    }
    return morton_code(cell, 21);
}

std::string counted(std::size_t n, const char* what, const char* why) {
    return std::to_string(n) + " " + what + (n == 1 ? " " : "s ") + why;
}

}  // namespace

SharedElements::SharedElements(const GeometryData& data, float frame_time, Report& report)
    : m_data(&data) {
    const auto equal_knots = [&](const auto& values, std::size_t n) {
        for (std::size_t i = n; i < values.size(); ++i)
            if (values[i] != values[i - n]) return false;
        return true;
    };
    const std::size_t n = data.vertex_count();
    m_static = equal_knots(data.points, n) && equal_knots(data.radius, n);
    const double at = m_static ? 0.0 : static_cast<double>(frame_time) * (data.knots - 1);
    m_frame_knot = static_cast<std::size_t>(at);
    m_frame_fraction = at - static_cast<double>(m_frame_knot);
    for (std::size_t v = 0; v < n; ++v)
        if (const Vec3f p(frame_point(v)); is_finite(p)) m_frame_box.add(p);
    if (data.kind == GeometryKind::Curves) {
        m_first_point.reserve(data.curve_sizes.size() + 1);
        m_first_point.push_back(0);
        for (const std::int32_t size : data.curve_sizes)
            m_first_point.push_back(m_first_point.back() + static_cast<std::uint32_t>(size));
    }
    find_elements(report);
    sort_by_place();
    make_batches();
}

Vec3d SharedElements::frame_point(std::size_t vertex) const {
    const std::size_t n = m_data->vertex_count();
    const Vec3d p(m_data->points[m_frame_knot * n + vertex]);
    if (m_frame_fraction == 0.0) return p;
    return p * (1.0 - m_frame_fraction) +
           Vec3d(m_data->points[(m_frame_knot + 1) * n + vertex]) * m_frame_fraction;
}

double SharedElements::frame_radius(std::size_t vertex) const {
    const std::size_t n = m_data->vertex_count(), knots = m_data->radius.size() / n;
    const auto at = [&](std::size_t knot) {
        return static_cast<double>(m_data->radius[std::min(knot, knots - 1) * n + vertex]);
    };
    const double now = at(m_frame_knot);
    return m_frame_fraction == 0.0
               ? now
               : now * (1.0 - m_frame_fraction) + at(m_frame_knot + 1) * m_frame_fraction;
}

void SharedElements::find_elements(Report& report) {
    const GeometryData& d = *m_data;
    const std::size_t n = d.vertex_count();
    std::vector<std::uint8_t> bad(n, 0), wide(n, 0);
    bool negative = false;
    for (std::size_t i = 0; i < d.points.size(); ++i)
        if (!is_finite(d.points[i])) bad[i % n] = 1;
    for (std::size_t i = 0; i < d.radius.size(); ++i) {
        if (!std::isfinite(d.radius[i])) bad[i % n] = 1;
        if (d.radius[i] > 0.0f) wide[i % n] = 1;
        negative = negative || d.radius[i] < 0.0f;
    }
    std::size_t broken = 0, flat = 0, lone = 0;
    m_order.reserve(d.element_count());
    for (std::uint32_t element = 0; element < d.element_count(); ++element) {
        const auto first = static_cast<std::ptrdiff_t>(first_point(element));
        const auto last = first + static_cast<std::ptrdiff_t>(point_count(element));
        const auto any = [&](const std::vector<std::uint8_t>& flags) {
            return std::any_of(flags.begin() + first, flags.begin() + last,
                               [](std::uint8_t flag) { return flag != 0; });
        };
        if (any(bad))
            ++broken;
        else if (d.kind == GeometryKind::Curves && point_count(element) < 2)
            ++lone;
        else if (!any(wide))
            ++flat;
        else
            m_order.push_back(element);
    }
    const char* what = d.kind == GeometryKind::Curves ? "curve" : "point";
    if (broken) report.warn(d.name, counted(broken, what, "with non-finite values left out"));
    if (lone) report.warn(d.name, counted(lone, what, "of a single point left out"));
    if (flat) report.warn(d.name, counted(flat, what, "without any radius left out"));
    if (negative) report.warn(d.name, "has negative radii, taken as 0");
}

void SharedElements::sort_by_place() {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> places;
    places.reserve(m_order.size());
    for (const std::uint32_t element : m_order)
        places.emplace_back(place_code(m_frame_box, frame_point(first_point(element))), element);
    std::sort(places.begin(), places.end(), [this](const auto& a, const auto& b) {
        return std::tuple(slot(a.second), a) < std::tuple(slot(b.second), b);
    });
    for (std::size_t i = 0; i < places.size(); ++i) m_order[i] = places[i].second;
}

void SharedElements::make_batches() {
    m_batches.push_back(0);
    std::size_t points = 0;
    for (std::uint32_t i = 0; i < m_order.size(); ++i) {
        const std::size_t size = point_count(m_order[i]);
        const std::size_t count = i - m_batches.back();
        if (count > 0 && (points + size > kBatchPoints || count >= kMostElements ||
                          slot(m_order[i]) != slot(m_order[i - 1]))) {
            m_batches.push_back(i);
            points = 0;
        }
        points += size;
    }
    if (!m_order.empty()) m_batches.push_back(static_cast<std::uint32_t>(m_order.size()));
}

std::uint64_t SharedElements::bytes() const {
    return sizeof(*this) + 4 * (m_first_point.size() + m_order.size() + m_batches.size());
}

std::vector<Bounds3f> element_boxes(const GeometryData& data) {
    std::vector<Bounds3f> boxes(static_cast<std::size_t>(data.knots));
    const std::size_t n = data.vertex_count();
    for (std::size_t i = 0; i < data.points.size(); ++i)
        if (is_finite(data.points[i])) boxes[i / n].add(data.points[i]);
    // A segment lies in the hull of its Bezier points: its ends, and these moved by a sixth of
    // their neighbours' chord.
    const auto add = [&](Bounds3f& box, const Vec3f& p, const Vec3f& chord) {
        if (!is_finite(p) || !is_finite(chord)) return;
        box.add(p + chord / 6.0f);
        box.add(p - chord / 6.0f);
    };
    for (std::size_t k = 0; k < boxes.size(); ++k) {
        const Vec3f* p = data.points.data() + k * n;
        for (const std::int32_t size : data.curve_sizes) {
            for (std::int32_t i = 0; i < size; ++i)
                add(boxes[k], p[i], p[std::min(i + 1, size - 1)] - p[std::max(i - 1, 0)]);
            p += size;
        }
    }
    return boxes;
}

}  // namespace granita
