// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/curve_control.h"

#include <algorithm>
#include <cmath>

#include "dice/opened_mesh.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Where a derivative is zero (a cusp) the curve's direction is that in which it arrives: of a
/// chord this long, in segments.
constexpr double kChord = 1e-3;

/// Pixels of a curl's length that one step over several segments may lose: as much as a segment may
/// leave its chord.
constexpr double kBend = 0.03;

/// Whether a difference of two places, seen from `from`, is more than their rounding.
bool apart(const Vec3d& difference, const Vec3d& from) {
    return glm::dot(difference, difference) > 1e-24 * (glm::dot(from, from) + 1e-60);
}

Vec3d any_perpendicular(const Vec3d& v) {
    const Vec3d a = glm::abs(v);
    const Vec3d axis = a.x <= a.y && a.x <= a.z ? Vec3d(1, 0, 0)
                       : a.y <= a.z             ? Vec3d(0, 1, 0)
                                                : Vec3d(0, 0, 1);
    return normalize_or(glm::cross(v, axis), Vec3d(1, 0, 0));
}

Vec3d unit(const Vec3d& v) {
    return normalize_or(v, Vec3d(0.0));
}

}  // namespace

double curve_middle(double lo, double hi) {
    const double middle = 0.5 * (lo + hi);
    const double point = std::max(std::floor(middle), std::floor(lo) + 1.0);
    return point < hi ? point : middle;
}

void CurveControl::gather(const OpenedElements& elements, std::uint32_t curve, double lo,
                          double hi) {
    const SharedElements& shared = elements.shared();
    const int n = static_cast<int>(shared.point_count(curve));
    m_elements = &elements;
    m_curve = curve;
    m_segments = n - 1;
    // Two more on each side: neighbours of the end segments, and those that a chord may reach.
    m_first = std::max(static_cast<int>(std::floor(lo)) - 2, 0);
    m_count = std::min(static_cast<int>(std::floor(hi)) + 4, n) - m_first;
    const std::size_t first = shared.first_point(curve) + static_cast<std::size_t>(m_first);
    m_points.clear();
    m_width = 0.0;
    for (int k = 0; k < elements.knot_count(); ++k)
        for (int i = 0; i < m_count; ++i) {
            const ElementPoint& point =
                m_points.emplace_back(elements.point(k, first + static_cast<std::size_t>(i)));
            m_width = std::max(m_width, elements.pixels(point.p, 2.0 * point.radius));
        }
}

CurveControl::Span CurveControl::span(int knot, double t) const {
    const int segment = std::clamp(static_cast<int>(std::floor(t)), 0, m_segments - 1);
    Span span{};
    for (int i = 0; i < 4; ++i) {
        const int index = std::clamp(segment - 1 + i, 0, m_segments);
        span.p[i] = &m_points[static_cast<std::size_t>(knot * m_count + index - m_first)];
    }
    span.t = t - segment;
    return span;
}

ElementPoint CurveControl::Span::at(const CatmullRom& basis) const {
    return {CatmullRom::sum<Vec3d>(basis.w, [&](int i) { return p[i]->p; }),
            std::max(CatmullRom::sum<double>(basis.w, [&](int i) { return p[i]->radius; }), 0.0)};
}

Vec3d CurveControl::Span::tangent(const CatmullRom& basis) const {
    return CatmullRom::sum<Vec3d>(basis.d, [&](int i) { return p[i]->p; });
}

ElementPoint CurveControl::at(int knot, double t) const {
    const Span s = span(knot, t);
    return s.at(CatmullRom(s.t));
}

Vec3d CurveControl::tangent(int knot, double t) const {
    const Span s = span(knot, t);
    return s.tangent(CatmullRom(s.t));
}

Vec3d CurveControl::arrival(int knot, double t) const {
    const Vec3d here = at(knot, t).p;
    const Vec3d chord = here - at(knot, std::max(t - kChord, 0.0)).p;
    if (apart(chord, here)) return chord;
    // Points in one place: it stands there, and comes from the last one that is elsewhere.
    const std::size_t first = m_elements->shared().first_point(m_curve);
    const auto point = [&](int i) {
        return m_elements->point(knot, first + static_cast<std::size_t>(i)).p;
    };
    const int last = std::min(static_cast<int>(std::floor(t)), m_segments);
    for (int i = last; i >= 0; --i)
        if (const Vec3d way = here - point(i); apart(way, here)) return way;
    for (int i = last + 1; i <= m_segments; ++i)
        if (const Vec3d way = point(i) - here; apart(way, here)) return way;
    return Vec3d(0.0);
}

RibbonRow CurveControl::row(int knot, double t, bool with_facing) const {
    RibbonRow row;
    const Span s = span(knot, t);
    const CatmullRom basis(s.t);
    const ElementPoint here = s.at(basis);
    row.center = here.p;
    Vec3d along = s.tangent(basis);
    // Rounding leaves a cusp's derivative a little off zero, in any direction.
    if (!apart(along, here.p)) along = arrival(knot, t);
    const Vec3d view = m_elements->view_direction(here.p);
    const Vec3d across = glm::cross(view, along);
    // A curve that runs straight to the eye has no side of its own.
    const bool seen_along =
        !(glm::dot(across, across) > 1e-18 * glm::dot(view, view) * glm::dot(along, along));
    Vec3d edge =
        seen_along ? any_perpendicular(glm::length(view) > 0.0 ? view : along) : unit(across);
    row.across = edge * here.radius;
    const UnevenScale& scale = m_elements->uneven_scale(knot);
    const bool is_ellipse = scale.is_uneven && !seen_along;
    Vec3d tangent(0.0), flat(0.0);
    if (is_ellipse) {
        // A ribbon of object space that faces the eye there, taken to the camera's as a whole.
        tangent = scale.object_from_camera * along;
        flat = unit(glm::cross(scale.object_from_camera * view, tangent));
        edge = scale.camera_from_object * flat;
        // What mirrors would change sides with the knots at which it is even.
        if (glm::dot(edge, across) < 0.0) {
            flat = -flat;
            edge = -edge;
        }
        row.across = edge * (here.radius / scale.largest);
    }
    if (!with_facing) return row;
    row.along = along;
    row.facing = unit(glm::cross(along, edge));
    if (seen_along || glm::length(row.facing) == 0.0) row.facing = unit(-view);
    if (glm::dot(row.facing, view) > 0.0) row.facing = -row.facing;
    row.side = edge;
    row.rise = row.facing * here.radius;
    if (!is_ellipse) return row;
    // Its tube's normals go with it.
    const Vec3d front = unit(glm::cross(tangent, flat));
    row.side = flat * scale.object_from_camera / glm::length(front * scale.object_from_camera);
    row.rise = scale.camera_from_object * front * (here.radius / scale.largest);
    if (glm::dot(row.rise, row.facing) < 0.0) row.rise = -row.rise;
    return row;
}

ElementPlace CurveControl::place(double t) const {
    const int segment = std::clamp(static_cast<int>(std::floor(t)), 0, m_segments - 1);
    const std::size_t point =
        m_elements->shared().first_point(m_curve) + static_cast<std::size_t>(segment);
    return {m_curve, point, point + 1, t - segment};
}

Bounds3f CurveControl::box(int knot, double lo, double hi) const {
    Bounds3f box;
    double radius = 0.0;
    for (double a = lo; a < hi;) {
        const double b = std::min(std::floor(a) + 1.0, hi);
        // The Bezier points of the part: the curve lies in their hull.  Its derivative is
        // continuous, so that at its end it is the next segment's.
        const Vec3d p = at(knot, a).p, q = at(knot, b).p, third((b - a) / 3.0);
        for (const Vec3d& corner :
             {p, p + tangent(knot, a) * third, q - tangent(knot, b) * third, q})
            box.add(Vec3f(corner));
        // Of the radius: cubic weights never add up to more than 5/4 of the largest.
        const Span s = span(knot, a);
        for (const ElementPoint* point : s.p) radius = std::max(radius, 1.25 * point->radius);
        a = b;
    }
    if (!box.empty()) box.grow(static_cast<float>(radius));
    return box;
}

CurveControl::Way CurveControl::way(int knot, double lo, double hi) const {
    const Projection& projection = m_elements->view().projection;
    const auto seen = [&](double t) {
        const Vec3d p = at(knot, t).p;
        const double z = std::max({p.z, projection.near_clip, 1e-9});
        return projection.scale * Vec2d(p) / (projection.perspective ? z : 1.0);
    };
    double pixels = 0.0;
    const Vec2d start = seen(lo), end = seen(hi);
    Vec2d from = start;
    for (double t = std::floor(lo) + 1.0; t < hi; t += 1.0) {
        const Vec2d to = seen(t);
        pixels += glm::distance(from, to);
        from = to;
    }
    return {pixels + glm::distance(from, end), glm::distance(start, end)};
}

void CurveControl::steps(double lo, double hi, std::size_t most, std::vector<double>& ends) const {
    if (ends.size() > most) return;
    const int knots = m_elements->knot_count();
    const bool several = std::floor(lo) + 1.0 < hi;
    const int budget =
        several ? kMostCurveLevels : kMostCurveLevels + std::min(std::ilogb(hi - lo), 0);
    Vec3f start[kMaxKnots], middle[kMaxKnots], end[kMaxKnots];
    const double half = curve_middle(lo, hi);
    bool bent = false;
    for (int k = 0; k < knots; ++k) {
        const Vec3d p = at(k, lo).p, q = at(k, hi).p;
        start[k] = Vec3f(p);
        if (several) {
            // Points between may lie anywhere: it asks for a straight piece that is seen as long as
            // the way over them.  (Along q - p a curl that runs to the eye would be a point.)
            const Projection& projection = m_elements->view().projection;
            const Way seen = way(k, lo, hi);
            bent = bent || seen.along - seen.straight > kBend;
            const double length = seen.along / projection.scale.x;
            const auto piece = [&](double part) {
                const double z = p.z + (q.z - p.z) * part;
                const double scale = projection.perspective && p.z > 0.0 ? z / p.z : 1.0;
                return Vec3f(Vec3d(p.x * scale + length * part * (projection.perspective ? z : 1.0),
                                   p.y * scale, z));
            };
            middle[k] = piece(0.5);
            end[k] = piece(1.0);
        } else {
            middle[k] = Vec3f(at(k, half).p);
            end[k] = Vec3f(q);
        }
    }
    // Of several segments it is not known how they bend, but for what a step over them would lose.
    const EdgeRate& rate = several ? m_elements->rate() : m_elements->rate_along(m_width);
    const int levels = rate.levels(start, middle, end, knots, budget);
    if (levels == 0 && !bent) {
        ends.push_back(hi);
    } else if (levels == EdgeRate::kAdaptive || several) {
        steps(lo, half, most, ends);
        steps(half, hi, most, ends);
    } else {
        const int n = 1 << levels;
        for (int i = 1; i <= n && ends.size() <= most; ++i)
            ends.push_back(i == n ? hi : lo + (hi - lo) * i / n);
    }
}

}  // namespace granita
