// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hider/micropolygon.h"
#include "hider/samples/sample_table.h"

namespace granita {

/// The samples of a tile by the surface that they see: in motion and behind a lens, neighbours see
/// different ones, and what is prepared of a surface is prepared once for all that see it.
class SurfaceGroups {
  public:
    /// False where so many surfaces are seen that samples hardly share them: nothing may be asked
    /// then.
    /// @param ids [samples]; kNoSurface belongs to no group.
    /// @param done [samples] 1 = belongs to none either.
    bool sort(std::span<const SurfaceId> ids, std::span<const std::uint8_t> done);
    /// Lays the samples out as they are sorted, for all groups at once: gathered group by group,
    /// vectors would be as empty as groups are small.
    void take_samples(const TileSamples& samples);
    std::size_t size() const { return m_ids.size(); }
    SurfaceId id(std::size_t group) const { return m_ids[group]; }
    /// Where the group's samples begin in sorted().
    std::size_t begin(std::size_t group) const { return m_begin[group]; }
    /// [samples of all groups], and kPadding of any.
    const TileSamples& sorted() const { return m_sorted; }
    static constexpr std::size_t kPadding = 16;
    /// In ascending order.
    std::span<const std::int32_t> samples(std::size_t group) const {
        return std::span(m_samples).subspan(m_begin[group], m_begin[group + 1] - m_begin[group]);
    }

  private:
    static constexpr std::size_t kMost = 4096;

    std::vector<std::uint16_t> m_slots;  ///< by hash of the id: its group and one, 0 = free
    std::vector<std::uint16_t> m_group;  ///< [samples] and one; 0 = sees none
    std::vector<SurfaceId> m_ids;        ///< [groups]
    std::vector<std::uint32_t> m_begin;  ///< [groups + 1] in m_samples
    std::vector<std::int32_t> m_samples;
    TileSamples m_sorted;
};

}  // namespace granita
