// SPDX-License-Identifier: GPL-3.0-or-later
// Chosen lanes moved together: included once a SIMD target inside its namespace, after
// packet_vectors.inl.

/// Brings the lanes of the mask to the front, in order; what follows is anything.  Several vectors
/// may share the mask.  Eight lanes have their own table: Highway 1.0's is copied in every call.
class Compact {
  public:
    HWY_INLINE explicit Compact(M mask) : m_mask(mask) {
        if constexpr (kByTable) {
            const auto digits = hn::Iota(kIdTag, 0) * hn::Set(kIdTag, 4);
            const auto lanes =
                hn::And(hn::Set(kIdTag, kLanes[bits_of(mask)]) >> digits, hn::Set(kIdTag, 7));
            m_lanes = hn::BitCast(kIntTag, lanes);
        }
    }
    HWY_INLINE V operator()(V values) const {
        if constexpr (kByTable)
            return hn::TableLookupLanes(values, hn::IndicesFromVec(kTag, m_lanes));
        else
            return hn::Compress(values, m_mask);
    }
    HWY_INLINE std::size_t count() const { return hn::CountTrue(kTag, m_mask); }

  private:
    static constexpr bool kByTable = hn::MaxLanes(kTag) == 8;
    /// [mask] lanes in order, a digit of four bits each.
    static constexpr std::array<std::uint32_t, 256> kLanes = [] {
        std::array<std::uint32_t, 256> table{};
        for (std::uint32_t mask = 0; mask < 256; ++mask)
            for (std::uint32_t lane = 0, to = 0; lane < 8; ++lane)
                if (mask >> lane & 1u) table[mask] |= lane << (4 * to++);
        return table;
    }();

    M m_mask;
    hn::Vec<IntTag> m_lanes;
};
