// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/enclosed_volumes.h"

#include <numeric>
#include <span>

namespace granita {
namespace {

/// Vertices that hang together by faces (union by halving paths).
class Pieces {
  public:
    explicit Pieces(std::size_t vertices) : m_parent(vertices) {
        std::iota(m_parent.begin(), m_parent.end(), std::size_t{0});
    }
    std::size_t of(std::size_t vertex) {
        while (m_parent[vertex] != vertex) vertex = m_parent[vertex] = m_parent[m_parent[vertex]];
        return vertex;
    }
    void join(std::size_t a, std::size_t b) { m_parent[of(a)] = of(b); }

  private:
    std::vector<std::size_t> m_parent;
};

}  // namespace

std::vector<std::int32_t> enclosed_volumes(
    const GeometryData& mesh, const std::function<std::int32_t(std::size_t)>& volume_of) {
    Pieces pieces(mesh.vertex_count());
    std::vector<std::size_t> first;  // vertex of each face
    std::size_t corner = 0;
    for (const std::int32_t size : mesh.face_sizes) {
        const std::span<const std::int32_t> verts(mesh.corner_verts.data() + corner,
                                                  static_cast<std::size_t>(size));
        first.push_back(static_cast<std::size_t>(verts[0]));
        for (const std::int32_t vertex : verts)
            pieces.join(static_cast<std::size_t>(vertex), first.back());
        corner += verts.size();
    }
    std::vector<std::int32_t> inside(mesh.vertex_count(), -1), result;
    for (std::size_t face = 0; face < first.size(); ++face) {
        std::int32_t& volume = inside[pieces.of(first[face])];
        if (volume < 0) volume = volume_of(face);
    }
    for (const std::size_t vertex : first) result.push_back(inside[pieces.of(vertex)]);
    return result;
}

}  // namespace granita
