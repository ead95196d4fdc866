// SPDX-License-Identifier: GPL-3.0-or-later
// Is a sample inside a micropolygon, and how deep: the arithmetic that all executors share.
//
// A corner is homogeneous in its tile's raster space, h = (X w, Y w, w), with its camera depth z;
// motion interpolates it linearly, the lens shears it, and only then is it seen from the sample:
//
//   offset d = (x + U s - X w, y + V s - Y w),  s = z / focus - 1      U, V: lens point in pixels
//   edge(a, b) = d_a.x d_b.y - d_a.y d_b.x                              exactly antisymmetric
//
// The sample is inside a triangle when its three edges have one sign, either one: both sides of a
// surface are visible.  The edges are the barycentric weights in camera space, so nothing is ever
// clipped or divided before coverage, whatever the sign of w (2-D homogeneous rasterization: Olano
// and Greer 1997); depth outside the clip range is rejected at the sample.
//
// Exactness.  The offsets of a vertex that micropolygons share are the same floats for all of them.
// Float subtraction of float products has the right sign or is 0, and where it is 0 the sign is
// taken exactly, with the sample shifted by (e, e^2), e -> 0 (simulation of simplicity:
// Edelsbrunner and Muecke 1990), i.e. by the direction of the edge's normal.  Hence a closed tiling
// covers every sample exactly once.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace granita {

#include "hider/corner_arithmetic.inl"

/// A micropolygon of a bucket: what GridPool::add gave its grid plus its index in the grid.
using SurfaceId = std::uint32_t;
inline constexpr SurfaceId kNoSurface = ~SurfaceId{0};

/// Which of a micropolygon's triangles exist: bits, so that both fit in a class byte.
enum Triangles : unsigned char { kTriangleA = 1, kTriangleB = 2 };

struct DepthRange {
    bool perspective = true;
    float key_far = 0.0f, key_near = INFINITY;
};

struct SurfaceHit {
    bool hit = false;
    float key = 0.0f;
    bool second = false;        ///< triangle (0, 2, 3) instead of (0, 1, 2)
    double b1 = 0.0, b2 = 0.0;  ///< weights of the triangle's second and third corner
};

namespace detail {

/// a b - c d; exactly 0 only if it is 0.
inline double product_difference(double a, double b, double c, double d) {
    const double ab = a * b, cd = c * d;
    return ab != cd ? ab - cd : std::fma(a, b, -ab) - std::fma(c, d, -cd);
}

inline int sign(double x) {
    return (x > 0.0) - (x < 0.0);
}

/// An edge and the side of it that the shifted sample is on; 0 for an edge without length.
struct Side {
    double edge;
    int sign;
};

inline Side side(const Offset<double>& a, double wa, const Offset<double>& b, double wb) {
    const double e = product_difference(a.x, b.y, a.y, b.x);
    if (e != 0.0) return {e, sign(e)};
    const double along_x = product_difference(a.y, wb, wa, b.y);
    if (along_x != 0.0) return {e, sign(along_x)};
    return {e, sign(product_difference(wa, b.x, a.x, wb))};
}

inline void hit_triangle(const Side& e01, const Side& e12, const Side& e20, const double z[3],
                         bool second, const DepthRange& range, SurfaceHit& best) {
    if (e01.sign == 0 || e01.sign != e12.sign || e01.sign != e20.sign) return;
    const double sum = e12.edge + e20.edge + e01.edge;
    if (sum == 0.0) return;
    const double b1 = e20.edge / sum, b2 = e01.edge / sum;
    const double z_hit = z[0] + b1 * (z[1] - z[0]) + b2 * (z[2] - z[0]);
    const double z_in =
        std::clamp(z_hit, std::min({z[0], z[1], z[2]}), std::max({z[0], z[1], z[2]}));
    const auto key = static_cast<float>(range.perspective ? 1.0 / z_in : -z_in);
    if (!(key >= range.key_far && key <= range.key_near)) return;
    if (!best.hit || key > best.key) best = {true, key, second, b1, b2};
}

}  // namespace detail

/// The exact test of both triangles at one sample; of a folded micropolygon the nearer triangle.
inline SurfaceHit hit_micropolygon(const Corner<double> c[4], const Offset<double> d[4],
                                   unsigned triangles, const DepthRange& range) {
    using detail::side;
    SurfaceHit best;
    const detail::Side e02 = side(d[0], c[0].w, d[2], c[2].w);
    const detail::Side e20 = {-e02.edge, -e02.sign};
    if (triangles & kTriangleA) {
        const double z[3] = {c[0].z, c[1].z, c[2].z};
        detail::hit_triangle(side(d[0], c[0].w, d[1], c[1].w), side(d[1], c[1].w, d[2], c[2].w),
                             e20, z, false, range, best);
    }
    if (triangles & kTriangleB) {
        const double z[3] = {c[0].z, c[2].z, c[3].z};
        detail::hit_triangle(e02, side(d[2], c[2].w, d[3], c[3].w),
                             side(d[3], c[3].w, d[0], c[0].w), z, true, range, best);
    }
    return best;
}

}  // namespace granita
