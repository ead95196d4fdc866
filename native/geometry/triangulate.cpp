// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/triangulate.h"

#include <algorithm>
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
    const Vec3d axis = std::abs(n.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d x = glm::normalize(glm::cross(axis, n)), y = glm::cross(n, x);
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

/// The corners not yet cut off, a ring, and which of them turn inwards: only those can lie in an
/// ear.
class Ring {
  public:
    explicit Ring(const std::vector<Vec2d>& points)
        : m_points(points), m_next(points.size()), m_last(points.size()) {
        const int n = static_cast<int>(points.size());
        for (int i = 0; i < n; ++i) {
            next(i) = (i + 1) % n;
            last(i) = (i + n - 1) % n;
        }
        for (int i = 0; i < n; ++i)
            if (turn(i) <= 0.0) m_inward.push_back(i);
    }
    int& next(int i) { return m_next[static_cast<std::size_t>(i)]; }
    int& last(int i) { return m_last[static_cast<std::size_t>(i)]; }
    const Vec2d& at(int i) const { return m_points[static_cast<std::size_t>(i)]; }
    double turn(int i) { return cross2(at(last(i)), at(i), at(next(i))); }

    bool is_ear(int i) {
        if (turn(i) <= 0.0) return false;
        const int a = last(i), c = next(i);
        for (const int v : m_inward) {
            if (v == a || v == i || v == c) continue;
            if (at(v) == at(a) || at(v) == at(i) || at(v) == at(c)) continue;
            if (contains(at(a), at(i), at(c), at(v))) return false;
        }
        return true;
    }
    void cut(int i) {
        const int a = last(i), c = next(i);
        next(a) = c;
        last(c) = a;
        std::erase_if(m_inward, [&](int v) { return v == i || turn(v) > 0.0; });
        // A corner with room to both sides can become flat, never the other way round.
        for (const int v : {a, c})
            if (turn(v) <= 0.0 && std::find(m_inward.begin(), m_inward.end(), v) == m_inward.end())
                m_inward.push_back(v);
    }

  private:
    const std::vector<Vec2d>& m_points;
    std::vector<int> m_next, m_last, m_inward;
};

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

QuadTriangles triangulate_quad(std::span<const Vec3f, 4> quad, bool by_normal) {
    QuadTriangles triangles;
    for (; triangles.start < 2; ++triangles.start) {
        const auto corner = [&](std::size_t i) {
            return Vec3d(quad[(static_cast<std::size_t>(triangles.start) + i) % 4]);
        };
        const Vec3d origin = corner(0), diagonal = corner(2) - origin;
        const Vec3d first = glm::cross(corner(1) - origin, diagonal);
        const Vec3d second = glm::cross(diagonal, corner(3) - origin);
        const double dot = glm::dot(first, second);
        const double first2 = glm::dot(first, first), second2 = glm::dot(second, second);
        // The quad's normal is the sum of theirs.
        const bool turns = by_normal ? dot + std::min(first2, second2) <= 0.0 : dot < 0.0;
        // The second cut is taken as it comes.
        if (turns && triangles.start == 0) continue;
        const double lengths = std::sqrt(first2 * second2);
        triangles.cosine = lengths > 0.0 ? dot / lengths : 1.0;
        break;
    }
    return triangles;
}

Triangulation triangulate(std::span<const Vec3f> polygon) {
    const std::size_t n = polygon.size();
    if (n == 3) return {{{0, 1, 2}}, true};
    const Vec3d normal = newell_normal(polygon);
    if (!(glm::dot(normal, normal) > 0.0)) return fan(n);
    const std::vector<Vec2d> flat = flatten(polygon, normal);

    Triangulation result;
    Ring ring(flat);
    int corner = 0;
    for (std::size_t left = n; left > 3; --left) {
        // An ear, or else a corner of no area: the ring is then a point narrower and no less full.
        int found = -1;
        for (const bool empty : {false, true})
            for (std::size_t i = 0; i < left && found < 0; ++i, corner = ring.next(corner))
                if (empty ? ring.turn(corner) == 0.0 : ring.is_ear(corner)) found = corner;
        if (found < 0) return fan(n);
        result.triangles.push_back({ring.last(found), found, ring.next(found)});
        corner = ring.next(ring.next(found));  // not all out of one corner
        ring.cut(found);
    }
    if (ring.turn(corner) < 0.0) return fan(n);
    result.triangles.push_back({ring.last(corner), corner, ring.next(corner)});
    return result;
}

}  // namespace granita
