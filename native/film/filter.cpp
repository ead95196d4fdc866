// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"

namespace granita {
namespace {

using std::numbers::pi;

/// Cubic of Mitchell and Netravali 1988 with support [-2, 2].
double cubic(double x, double b, double c) {
    x = std::fabs(x);
    if (x < 1.0)
        return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) /
               6;
    if (x < 2.0)
        return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
                (8 * b + 24 * c)) /
               6;
    return 0.0;
}

double sinc(double x) {
    return std::fabs(x) < 1e-8 ? 1.0 : std::sin(pi * x) / (pi * x);
}

/// Four terms (Harris 1978); x in [0, 1] across the window.
double blackman_harris(double x) {
    return 0.35875 - 0.48829 * std::cos(2 * pi * x) + 0.14128 * std::cos(4 * pi * x) -
           0.01168 * std::cos(6 * pi * x);
}

float filter_radius(FilterKind kind, float width) {
    switch (kind) {
        case FilterKind::Gaussian:
            return 1.5f * width;
        case FilterKind::BlackmanHarris:
            return width;
        default:
            return 0.5f * width;
    }
}

/// Simpson's rule; the steps of all filters fall on their knots, multiples of radius / 6.
template <class F>
double integrate(F f, double from, double to) {
    constexpr int kSteps = 12288;
    const double h = (to - from) / kSteps;
    double sum = f(from) + f(to);
    for (int i = 1; i < kSteps; ++i) sum += (i % 2 ? 4.0 : 2.0) * f(from + i * h);
    return sum * h / 3.0;
}

}  // namespace

PixelFilter::PixelFilter(FilterKind kind, float width)
    : m_kind(kind), m_width(width), m_radius(filter_radius(kind, width)), m_scale(1.0f) {
    if (!(width > 0.0f) || !std::isfinite(width) || width > 256.0f)
        throw SceneError("render settings", "filter_width must be between 0 and 256 pixels, not " +
                                                std::to_string(width));
    const double half = integrate([&](double d) { return shape(d); }, 0.0, m_radius);
    m_scale = static_cast<float>(0.5 / half);
}

double PixelFilter::shape(double d) const {
    const double r = m_radius;
    switch (m_kind) {
        case FilterKind::Box:
            return 1.0;
        case FilterKind::Tent:
            return 1.0 - std::fabs(d) / r;
        case FilterKind::Gaussian:
            return std::exp(-8.0 * d * d / (static_cast<double>(m_width) * m_width));
        case FilterKind::BlackmanHarris:
            return blackman_harris(0.5 + 0.5 * d / r);
        case FilterKind::Mitchell:
            return cubic(2.0 * d / r, 1.0 / 3, 1.0 / 3);
        case FilterKind::CatmullRom:
            return cubic(2.0 * d / r, 0.0, 0.5);
        case FilterKind::Bspline:
            return cubic(2.0 * d / r, 1.0, 0.0);
        case FilterKind::Lanczos:
            return sinc(3.0 * d / r) * sinc(d / r);
    }
    return 0.0;
}

float PixelFilter::evaluate(float d) const {
    if (m_kind == FilterKind::Box) return d >= -m_radius && d < m_radius ? m_scale : 0.0f;
    if (!(std::fabs(d) < m_radius)) return 0.0f;
    return m_scale * static_cast<float>(shape(d));
}

double PixelFilter::edge_response(double d) const {
    const double r = m_radius;
    if (d <= -r) return 0.0;
    if (d >= r) return 1.0;
    const auto f = [&](double x) { return shape(x); };
    const double half = integrate(f, 0.0, r);
    return 0.5 + std::copysign(integrate(f, 0.0, std::fabs(d)), d) / (2.0 * half);
}

}  // namespace granita
