// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/triangulate.h"

#include <cmath>

namespace granita {
namespace {

double cross2(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon on its best-fit plane, counter-clockwise; relative to its first corner, so that far
/// polygons keep their bits.
std::vector<Vec2d> flatten(std::span<const Vec3f> polygon, const Vec3d& normal) {
    const Vec3d n = glm::normalize(normal);
    const Vec3d helper = std::abs(n.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d x = glm::normalize(glm::cross(helper, n)), y = glm::cross(n, x);
    std::vector<Vec2d> flat;
    flat.reserve(polygon.size());
    for (const Vec3f& p : polygon) {
        const Vec3d d = Vec3d(p) - Vec3d(polygon[0]);
        flat.emplace_back(glm::dot(d, x), glm::dot(d, y));
    }
    return flat;
}

bool contains(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& p) {
    return cross2(a, b, p) >= 0 && cross2(b, c, p) >= 0 && cross2(c, a, p) >= 0;
}

/// Whether the corner at position k of the remaining loop is an ear.  `slack` lets flat corners go
/// when nothing better is left.
bool is_ear(const std::vector<Vec2d>& p, const std::vector<int>& loop, std::size_t k, bool flat) {
    const std::size_t n = loop.size();
    const int a = loop[(k + n - 1) % n], b = loop[k], c = loop[(k + 1) % n];
    const double area = cross2(p[a], p[b], p[c]);
    if (flat ? area != 0.0 : area <= 0.0) return false;
    if (flat) return true;
    for (std::size_t m = 0; m < n; ++m) {
        const int v = loop[m];
        if (v == a || v == b || v == c) continue;
        if (p[v] == p[a] || p[v] == p[b] || p[v] == p[c]) continue;
        if (contains(p[a], p[b], p[c], p[v])) return false;
    }
    return true;
}

Triangulation fan(std::size_t corners) {
    Triangulation result;
    result.simple = false;
    for (int i = 1; i + 1 < static_cast<int>(corners); ++i)
        result.triangles.push_back({0, i, i + 1});
    return result;
}

}  // namespace

Vec3d newell_normal(std::span<const Vec3f> polygon) {
    Vec3d sum(0.0);
    const Vec3d origin(polygon[0]);
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        sum += glm::cross(Vec3d(polygon[i]) - origin, Vec3d(polygon[i + 1]) - origin);
    return sum;
}

bool is_convex_quad(std::span<const Vec3f> quad) {
    const Vec3d normal = newell_normal(quad);
    for (int i = 0; i < 4; ++i) {
        const Vec3d a(quad[(i + 3) % 4]), b(quad[i]), c(quad[(i + 1) % 4]);
        if (glm::dot(glm::cross(b - a, c - b), normal) < 0.0) return false;
    }
    return true;
}

Triangulation triangulate(std::span<const Vec3f> polygon) {
    const std::size_t n = polygon.size();
    if (n == 3) return {{{0, 1, 2}}, true};
    const Vec3d normal = newell_normal(polygon);
    if (!(glm::dot(normal, normal) > 0.0)) return fan(n);
    const std::vector<Vec2d> flat = flatten(polygon, normal);

    Triangulation result;
    std::vector<int> loop(n);
    for (std::size_t i = 0; i < n; ++i) loop[i] = static_cast<int>(i);
    // Starting each search behind the last ear keeps triangles from fanning out of one corner.
    std::size_t start = 0;
    while (loop.size() > 3) {
        bool found = false;
        for (bool flat_corner : {false, true}) {
            for (std::size_t s = 0; s < loop.size() && !found; ++s) {
                const std::size_t k = (start + s) % loop.size();
                if (!is_ear(flat, loop, k, flat_corner)) continue;
                const std::size_t m = loop.size();
                result.triangles.push_back({loop[(k + m - 1) % m], loop[k], loop[(k + 1) % m]});
                loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(k));
                start = (k + 1) % loop.size();
                found = true;
            }
            if (found) break;
        }
        if (!found) return fan(n);
    }
    if (cross2(flat[loop[0]], flat[loop[1]], flat[loop[2]]) < 0.0) return fan(n);
    result.triangles.push_back({loop[0], loop[1], loop[2]});
    return result;
}

}  // namespace granita
