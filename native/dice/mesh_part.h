// SPDX-License-Identifier: GPL-3.0-or-later
// What of a mesh is opened: all of it, or the patches that samples meet (SampledFaces) and their
// vertices, which lie close together then.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/shared_geometry.h"

namespace granita {

class MeshPart {
  public:
    explicit MeshPart(const SharedGeometry& shared);
    /// `patches`: ascending numbers.
    MeshPart(const SharedGeometry& shared, std::vector<std::uint32_t> patches);

    bool is_whole() const { return m_is_whole; }
    std::size_t patch_count() const { return m_patch_count; }
    std::uint32_t patch(std::size_t i) const {
        return m_is_whole ? static_cast<std::uint32_t>(i) : m_patches[i];
    }
    std::size_t vertex_count() const { return m_vertex_count; }
    /// The geometry's number of the part's.
    std::uint32_t vertex(std::size_t place) const {
        return m_is_whole ? static_cast<std::uint32_t>(place) : m_vertices[place];
    }
    /// The part's number of the geometry's, which a corner of one of its patches is.
    std::size_t place(std::size_t vertex) const {
        return m_is_whole ? vertex : m_table[row_of(static_cast<std::uint32_t>(vertex))];
    }
    std::uint64_t bytes() const {
        return 4 * (m_patches.size() + m_vertices.size() + m_table.size());
    }

  private:
    static constexpr std::uint32_t kNone = ~0u;
    /// In m_table: of a vertex, or where it would be.
    std::size_t row_of(std::uint32_t vertex) const {
        std::size_t row = (vertex * 0x9e3779b9u) >> m_shift;  // Knuth's multiplicative hash
        while (m_table[row] != kNone && m_vertices[m_table[row]] != vertex)
            row = (row + 1) & (m_table.size() - 1);
        return row;
    }

    bool m_is_whole;
    std::size_t m_patch_count, m_vertex_count;
    // Empty where whole.
    std::vector<std::uint32_t> m_patches, m_vertices;
    std::vector<std::uint32_t> m_table;  ///< places by vertex, at most half of its rows are filled
    int m_shift = 0;                     ///< 2^(32 - shift) rows
};

}  // namespace granita
