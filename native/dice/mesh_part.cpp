// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/mesh_part.h"

#include <bit>

namespace granita {

MeshPart::MeshPart(const SharedGeometry& shared)
    : m_is_whole(true),
      m_patch_count(shared.patches().size()),
      m_vertex_count(shared.data().vertex_count()) {}

MeshPart::MeshPart(const SharedGeometry& shared, std::vector<std::uint32_t> patches)
    : m_is_whole(false), m_patch_count(patches.size()), m_patches(std::move(patches)) {
    const int digits = std::bit_width(8 * m_patches.size() + 1);
    m_shift = 32 - digits;
    m_table.assign(std::size_t{1} << digits, kNone);
    m_vertices.reserve(4 * m_patches.size());
    for (const std::uint32_t patch : m_patches)
        for (const std::uint32_t corner : shared.patches()[patch].corner) {
            const auto vertex = static_cast<std::uint32_t>(shared.data().corner_verts[corner]);
            std::uint32_t& row = m_table[row_of(vertex)];
            if (row != kNone) continue;
            row = static_cast<std::uint32_t>(m_vertices.size());
            m_vertices.push_back(vertex);
        }
    m_vertex_count = m_vertices.size();
}

}  // namespace granita
