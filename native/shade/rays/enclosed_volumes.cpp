// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/enclosed_volumes.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace granita {
namespace {

/// Sets that grow together (union by halving paths).
class Pieces {
  public:
    explicit Pieces(std::size_t count) : m_parent(count) {
        std::iota(m_parent.begin(), m_parent.end(), std::size_t{0});
    }
    std::size_t of(std::size_t i) {
        while (m_parent[i] != i) i = m_parent[i] = m_parent[m_parent[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) { m_parent[of(a)] = of(b); }

  private:
    std::vector<std::size_t> m_parent;
};

/// [vertices] the first vertex in the same place: files split them where materials and normals do.
std::vector<std::size_t> first_in_place(const GeometryData& mesh) {
    const auto by_place = [&](std::size_t a, std::size_t b) {
        const Vec3f &p = mesh.points[a], &q = mesh.points[b];
        return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
    };
    std::vector<std::size_t> order(mesh.vertex_count()), first(mesh.vertex_count());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, by_place);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && mesh.points[order[i]] == mesh.points[order[i - 1]];
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    return first;
}

struct Edge {
    std::size_t from, to, face;  ///< from < to

    std::pair<std::size_t, std::size_t> ends() const { return {from, to}; }
};

std::vector<Edge> edges_of(const GeometryData& mesh) {
    const std::vector<std::size_t> vertex = first_in_place(mesh);
    std::vector<Edge> edges;
    edges.reserve(mesh.corner_verts.size());
    const std::int32_t* corners = mesh.corner_verts.data();
    for (std::size_t face = 0; face < mesh.face_count(); ++face) {
        const auto size = static_cast<std::size_t>(mesh.face_sizes[face]);
        for (std::size_t k = 0; k < size; ++k) {
            const std::size_t a = vertex[static_cast<std::size_t>(corners[k])];
            const std::size_t b = vertex[static_cast<std::size_t>(corners[(k + 1) % size])];
            edges.push_back({std::min(a, b), std::max(a, b), face});
        }
        corners += size;
    }
    std::ranges::sort(edges, {}, &Edge::ends);
    return edges;
}

}  // namespace

std::vector<std::int32_t> enclosed_volumes(
    const GeometryData& mesh, const std::function<std::int32_t(std::size_t)>& volume_of) {
    const std::vector<Edge> edges = edges_of(mesh);
    Pieces pieces(mesh.face_count());
    for (std::size_t i = 0, end; i < edges.size(); i = end) {
        for (end = i; end < edges.size() && edges[end].ends() == edges[i].ends();) ++end;
        if (end - i == 2) pieces.join(edges[i].face, edges[i + 1].face);
    }
    std::vector<std::int32_t> inside(mesh.face_count(), -1), result;
    for (std::size_t face = 0; face < inside.size(); ++face) {
        std::int32_t& volume = inside[pieces.of(face)];
        if (volume < 0) volume = volume_of(face);
    }
    for (std::size_t face = 0; face < inside.size(); ++face)
        result.push_back(inside[pieces.of(face)]);
    return result;
}

}  // namespace granita
