// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/random_per_island.h"

#include <numeric>

#include "math/hash.h"

namespace granita {

namespace {

/// Union by rank: of two trees the one that is as deep or deeper keeps its root.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : m_parent(count), m_rank(count) {
        std::iota(m_parent.begin(), m_parent.end(), 0u);
    }

    std::uint32_t root(std::uint32_t x) {
        while (m_parent[x] != x) x = m_parent[x] = m_parent[m_parent[x]];
        return x;
    }

    void join(std::uint32_t x, std::uint32_t y) {
        x = root(x), y = root(y);
        if (x == y) return;
        if (m_rank[x] < m_rank[y]) std::swap(x, y);
        m_parent[y] = x;
        if (m_rank[x] == m_rank[y]) ++m_rank[x];
    }

  private:
    std::vector<std::uint32_t> m_parent;
    std::vector<std::uint8_t> m_rank;
};

}  // namespace

Attribute random_per_island(const GeometryData& geometry, const std::vector<std::int32_t>& edges) {
    DisjointSets sets(geometry.vertex_count());
    for (std::size_t i = 0; i + 1 < edges.size(); i += 2)
        sets.join(static_cast<std::uint32_t>(edges[i]), static_cast<std::uint32_t>(edges[i + 1]));
    Attribute attribute{kIslandAttribute, Domain::Face, AttributeKind::Generic, 1, {}};
    attribute.values.reserve(geometry.face_count());
    std::size_t corner = 0;
    for (const std::int32_t size : geometry.face_sizes) {
        const std::uint32_t root =
            sets.root(static_cast<std::uint32_t>(geometry.corner_verts[corner]));
        attribute.values.push_back(
            static_cast<float>(hash_words(std::array<std::uint32_t, 1>{root})) /
            static_cast<float>(0xffffffffu));
        corner += static_cast<std::size_t>(size);
    }
    return attribute;
}

}  // namespace granita
