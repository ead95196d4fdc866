// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "math/normalize_or.h"

namespace granita {
namespace {

constexpr int kNone = -1;

struct CornerHash {
    std::size_t operator()(const TangentCorner& c) const {
        std::uint64_t hash = 0;
        for (const float value : {c.position.x, c.position.y, c.position.z, c.normal.x, c.normal.y,
                                  c.normal.z, c.uv.x, c.uv.y})
            // Both zeros are one.
            hash = (hash ^ std::bit_cast<std::uint32_t>(value + 0.0f)) * 0x9e3779b97f4a7c15ULL ^
                   hash >> 29;
        return hash;
    }
};

struct Triangle {
    std::array<int, 3> vertex{};                        ///< equal corners have equal numbers
    std::array<int, 3> neighbour{kNone, kNone, kNone};  ///< across the side that leaves a corner
    std::array<int, 3> group{kNone, kNone, kNone};      ///< of its corners
    Vec3f along_u{0.0f};                                ///< unit, in its plane
    bool upright = false;                               ///< the map is not mirrored
    bool joins_any = true;    ///< has no area in the map: takes its neighbours' sense
    bool degenerate = false;  ///< two of its corners are in one place
};

struct Group {
    bool upright;
    Vec3f sum{0.0f};
};

class TangentSpace {
  public:
    explicit TangentSpace(std::span<const TangentCorner> corners)
        : m_corners(corners), m_triangles(corners.size() / 3) {
        weld();
        for (std::size_t t = 0; t < m_triangles.size(); ++t) measure(t);
        link();
        for (std::size_t t = 0; t < m_triangles.size(); ++t)
            for (int i = 0; i < 3; ++i) start_group(static_cast<int>(t), i);
        for (std::size_t t = 0; t < m_triangles.size(); ++t)
            for (int i = 0; i < 3; ++i) add_to_group(t, i);
    }

    std::vector<Vec4f> values() const {
        std::vector<Vec4f> values(m_corners.size(), Vec4f(1.0f, 0.0f, 0.0f, -1.0f));
        std::vector<int> of_vertex(m_corners.size(), kNone);
        for (const Triangle& triangle : m_triangles)
            for (std::size_t i = 0; i < 3; ++i)
                if (triangle.group[i] != kNone) of_vertex[triangle.vertex[i]] = triangle.group[i];
        for (std::size_t t = 0; t < m_triangles.size(); ++t)
            for (std::size_t i = 0; i < 3; ++i) {
                // What has no area takes what it can get.
                int group = m_triangles[t].group[i];
                if (group == kNone) group = of_vertex[m_triangles[t].vertex[i]];
                if (group == kNone) continue;
                const Group& from = m_groups[static_cast<std::size_t>(group)];
                values[3 * t + i] = Vec4f(normalize_or(from.sum, Vec3f(1.0f, 0.0f, 0.0f)),
                                          from.upright ? 1.0f : -1.0f);
            }
        return values;
    }

  private:
    const TangentCorner& corner(std::size_t triangle, int i) const {
        return m_corners[3 * triangle + static_cast<std::size_t>(i)];
    }

    void weld() {
        std::unordered_map<TangentCorner, int, CornerHash> numbers(m_corners.size());
        for (std::size_t c = 0; c < m_corners.size(); ++c)
            m_triangles[c / 3].vertex[c % 3] =
                numbers.try_emplace(m_corners[c], static_cast<int>(numbers.size())).first->second;
    }

    void measure(std::size_t t) {
        Triangle& triangle = m_triangles[t];
        const TangentCorner &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
        triangle.degenerate =
            a.position == b.position || b.position == c.position || c.position == a.position;
        const Vec2f ab = b.uv - a.uv, ac = c.uv - a.uv;
        const float area = ab.x * ac.y - ab.y * ac.x;
        triangle.upright = area > 0.0f;
        if (area == 0.0f) return;
        const Vec3f along = (b.position - a.position) * ac.y - (c.position - a.position) * ab.y;
        const float length = glm::length(along);
        if (!(length > 0.0f)) return;
        triangle.along_u = along * ((triangle.upright ? 1.0f : -1.0f) / length);
        triangle.joins_any = false;
    }

    /// Two triangles at a side that they run along in opposite directions.
    void link() {
        struct Side {
            int triangle, side;
        };
        std::unordered_map<std::uint64_t, std::vector<Side>> open;
        const auto key = [](int from, int to) {
            return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
        };
        for (std::size_t t = 0; t < m_triangles.size(); ++t) {
            Triangle& triangle = m_triangles[t];
            if (triangle.degenerate) continue;
            for (int i = 0; i < 3; ++i) {
                const int from = triangle.vertex[i], to = triangle.vertex[(i + 1) % 3];
                const auto other = open.find(key(to, from));
                if (other == open.end() || other->second.empty()) {
                    open[key(from, to)].push_back({static_cast<int>(t), i});
                    continue;
                }
                const Side side = other->second.front();
                other->second.erase(other->second.begin());
                triangle.neighbour[i] = side.triangle;
                m_triangles[static_cast<std::size_t>(side.triangle)].neighbour[side.side] =
                    static_cast<int>(t);
            }
        }
    }

    /// The corners around a vertex that are reached over sides between triangles of one sense.
    void start_group(int first, int corner) {
        const Triangle& start = m_triangles[static_cast<std::size_t>(first)];
        if (start.degenerate || start.joins_any || start.group[corner] != kNone) return;
        const int vertex = start.vertex[corner], group = static_cast<int>(m_groups.size());
        m_groups.push_back({start.upright});
        std::vector<int> waiting{first};
        while (!waiting.empty()) {
            Triangle& triangle = m_triangles[static_cast<std::size_t>(waiting.back())];
            waiting.pop_back();
            const auto at = std::find(triangle.vertex.begin(), triangle.vertex.end(), vertex);
            const auto i = static_cast<int>(at - triangle.vertex.begin());
            if (triangle.group[i] != kNone) continue;
            const auto assigned = [](int g) { return g != kNone; };
            if (triangle.joins_any &&
                std::none_of(triangle.group.begin(), triangle.group.end(), assigned))
                triangle.upright = start.upright;
            if (triangle.upright != start.upright) continue;
            triangle.group[i] = group;
            for (const int next : {triangle.neighbour[i], triangle.neighbour[(i + 2) % 3]})
                if (next != kNone) waiting.push_back(next);
        }
    }

    void add_to_group(std::size_t t, int i) {
        const Triangle& triangle = m_triangles[t];
        if (triangle.group[i] == kNone || triangle.joins_any) return;
        const TangentCorner& here = corner(t, i);
        const auto in_plane = [&here](const Vec3f& v) {
            return normalize_or(v - here.normal * glm::dot(here.normal, v), Vec3f(0.0f));
        };
        const Vec3f next = in_plane(corner(t, (i + 1) % 3).position - here.position);
        const Vec3f last = in_plane(corner(t, (i + 2) % 3).position - here.position);
        const float angle = std::acos(std::clamp(glm::dot(next, last), -1.0f, 1.0f));
        m_groups[static_cast<std::size_t>(triangle.group[i])].sum +=
            angle * in_plane(triangle.along_u);
    }

    std::span<const TangentCorner> m_corners;
    std::vector<Triangle> m_triangles;
    std::vector<Group> m_groups;
};

}  // namespace

std::vector<Vec4f> tangents(std::span<const TangentCorner> corners) {
    return TangentSpace(corners).values();
}

}  // namespace granita
