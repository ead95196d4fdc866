// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace granita {

/// Which grids samples see, pass by pass: what shaders/raster/marks.glsl leaves.
class RasterSeen {
  public:
    /// Nothing is known: everything may be seen.
    RasterSeen() = default;
    /// `marks`: [grids][words_for(passes)], grids by key.
    RasterSeen(std::vector<std::uint32_t> marks, int passes)
        : m_marks(std::move(marks)), m_words(words_for(passes)) {}

    static std::size_t words_for(int passes) {
        return (static_cast<std::size_t>(passes) + 31) / 32;
    }

    bool in_pass(std::size_t grid, int pass) const {
        const auto p = static_cast<std::size_t>(pass);
        return m_marks.empty() || (m_marks[grid * m_words + p / 32] >> p % 32 & 1) != 0;
    }
    /// Any grid of [first, end).
    bool in_pass(std::size_t first, std::size_t end, int pass) const {
        for (std::size_t grid = first; grid < end; ++grid)
            if (in_pass(grid, pass)) return true;
        return false;
    }
    /// In any pass.
    bool ever(std::size_t grid) const {
        for (std::size_t word = 0; word < m_words; ++word)
            if (m_marks[grid * m_words + word] != 0) return true;
        return m_marks.empty();
    }

  private:
    std::vector<std::uint32_t> m_marks;
    std::size_t m_words = 0;
};

}  // namespace granita
