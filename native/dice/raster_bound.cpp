// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/raster_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dice/point_bounds.h"
#include "math/point_span.h"

namespace granita {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The hider works in float relative to a tile; its rounding and ours stay inside this, in pixels.
constexpr double kMargin = 1.0 / 256.0;

/// Of a place found in single precision, of its distance from the centre: a few roundings of 2^-24.
constexpr double kRounding = 0x1p-21;

/// Depths, metres, at which single precision does not reach what is seen.
constexpr float kEye = 1e-20f;

struct Interval {
    double lo = kInfinity, hi = -kInfinity;
    void add(double x, double reach) {
        lo = std::min(lo, x - reach);
        hi = std::max(hi, x + reach);
    }
};

RasterBounds finish(const Projection& projection, const Interval& x, const Interval& y,
                    float z_lo) {
    RasterBounds bounds;
    const auto low = [](double v) {
        return std::nextafter(static_cast<float>(v - kMargin), -INFINITY);
    };
    const auto high = [](double v) {
        return std::nextafter(static_cast<float>(v + kMargin), INFINITY);
    };
    bounds.x0 = low(x.lo), bounds.x1 = high(x.hi);
    bounds.y0 = low(y.lo), bounds.y1 = high(y.hi);
    bounds.nearest_key =
        projection.depth_key(std::max(z_lo, static_cast<float>(projection.near_clip)));
    bounds.visible = true;
    return bounds;
}

bool in_clip_range(const Projection& projection, float z_lo, float z_hi) {
    return z_hi >= projection.near_clip && z_lo <= projection.far_clip;
}

}  // namespace

RasterBounds raster_bound(const Projection& projection, const Bounds3f& box) {
    if (box.empty() || !in_clip_range(projection, box.lo.z, box.hi.z)) return {};
    const bool crosses = projection.perspective && box.lo.z <= 0.0f;
    const double z_near = projection.perspective
                              ? std::max<double>(box.lo.z, crosses ? projection.near_clip : 0.0)
                              : box.lo.z;
    const double z_far = std::max<double>(box.hi.z, z_near);
    // What is seen has z in [z_near, z_far].  On either side of the focus (v +- R |z / focus - 1|)
    // / z is monotone in z, and at the focus it is v / z without a reach: the ends bound it, also
    // of the larger of two focuses' reaches.  So a floor that passes below the lens stays below the
    // frame, however large its circle of confusion grows.
    const auto axis = [&](int i, double lo, double hi) {
        Interval interval;
        for (const double z : {z_near, z_far}) {
            const double w = projection.perspective ? 1.0 / z : 1.0;
            const double reach = projection.scale[i] * projection.lens_reach(z) * w;
            for (const double v : {lo, hi})
                interval.add(projection.center[i] + projection.scale[i] * v * w, reach);
        }
        return interval;
    };
    return finish(projection, axis(0, box.lo.x, box.hi.x), axis(1, box.lo.y, box.hi.y), box.lo.z);
}

RasterBounds raster_bound_of(const Projection& projection, std::span<const Bounds3f> boxes) {
    Bounds3f all;
    for (const Bounds3f& box : boxes) all.add(box);
    return raster_bound(projection, all);
}

PointBounds::PointBounds(const Projection& projection)
    : m_projection(&projection),
      m_perspective(projection.perspective),
      m_radius(static_cast<float>(projection.lens_radius)),
      m_near_focus(projection.has_lens() ? static_cast<float>(1.0 / projection.focus) : 0.0f),
      m_far_focus(projection.has_lens() ? static_cast<float>(1.0 / projection.farthest_focus())
                                        : 0.0f) {}

void PointBounds::add(std::span<const Vec3f> points) {
    m_box.add(bounds_of(points));
    // Planes of one depth are bounded by their box.
    if (!m_perspective && !m_projection->has_lens()) return;
    // In single precision.  What a lens shifts is its radius times |1 / focus - 1 / z|, and in an
    // orthographic view times |z / focus - 1|.
    for (const Vec3f& p : points) {
        const float w = m_perspective ? 1.0f / p.z : 1.0f;
        const float u = m_perspective ? 1.0f : p.z;
        const float shear = std::max(std::abs(u * m_near_focus - w), std::abs(u * m_far_focus - w));
        const Vec2f at = Vec2f(p) * w, reach(m_radius * shear);
        m_lo = glm::min(m_lo, at - reach);
        m_hi = glm::max(m_hi, at + reach);
    }
}

void PointBounds::add(const PointBounds& other) {
    m_box.add(other.m_box);
    m_lo = glm::min(m_lo, other.m_lo);
    m_hi = glm::max(m_hi, other.m_hi);
}

RasterBounds PointBounds::bounds() const {
    const Projection& projection = *m_projection;
    if (m_box.empty() || !in_clip_range(projection, m_box.lo.z, m_box.hi.z)) return {};
    // As tight where planes of one depth are seen alike.
    const bool by_box = m_perspective ? m_box.lo.z < kEye : !projection.has_lens();
    if (by_box) return raster_bound(projection, m_box);
    Interval x, y;
    const auto add = [&](Interval& interval, int i, float at) {
        const double off_center = projection.scale[i] * at;
        interval.add(projection.center[i] + off_center, std::abs(off_center) * kRounding);
    };
    for (const Vec2f& at : {m_lo, m_hi}) {
        add(x, 0, at.x);
        add(y, 1, at.y);
    }
    return finish(projection, x, y, m_box.lo.z);
}

RasterBounds raster_bound(const Projection& projection, std::span<const Vec3f> points) {
    PointBounds bounds(projection);
    bounds.add(points);
    return bounds.bounds();
}

}  // namespace granita
