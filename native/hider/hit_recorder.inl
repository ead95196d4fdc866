// SPDX-License-Identifier: GPL-3.0-or-later
// What the samples that a micropolygon covers see: included once a SIMD target inside its
// namespace, after sample_test.inl and vector_fragments.inl.

/// Hits in different slots, in the order in which they came.
template <std::size_t kMost>
struct HitList {
    float key[kMost], slot[kMost], signed_b1[kMost], b2[kMost];  ///< slot: bits of an int
};

/// Opaque hits go into the tile's key and id; transparent ones that are not behind them into lists.
class HitRecorder {
  public:
    HitRecorder(const SimdGrid& grid, const SimdTile& tile, const Target& target,
                FragmentLists& lists, SimdCounts& counts)
        : m_grid(grid), m_tile(tile), m_target(target), m_lists(lists), m_counts(counts) {}

    /// Of the vector of slots from `first` on.
    HWY_INLINE void record(const Hits& hits, M hit, std::size_t first) {
        const V key = hits.key;
        m_counts.hits += hn::CountTrue(kTag, hit);
        const V stored = hn::LoadU(kTag, m_tile.key + first);
        const M nearer = hn::And(hit, hn::Gt(key, stored));
        const M equal = hn::And(hit, hn::Eq(key, stored));
        if (m_target.kind & kTransparent) {
            M visible = nearer;
            if (HWY_UNLIKELY(!hn::AllFalse(kTag, equal))) {
                alignas(64) float wins[kPacket] = {};
                for_each_lane(equal, [&](int lane) {
                    wins[lane] = wins_tie(m_tile.id[first + lane]) ? 1.0f : 0.0f;
                });
                visible = hn::Or(visible, hn::Gt(hn::Load(kTag, wins), set(0.0f)));
            }
            if (hn::AllFalse(kTag, visible)) return;
            m_counts.fragments += hn::CountTrue(kTag, visible);
            const V id = hn::BitCast(kTag, hn::Set(kIdTag, m_target.id));
            add_fragments({hits.key, id, hits.signed_b1, hits.b2}, visible, first, m_lists);
            return;
        }
        if (HWY_UNLIKELY(!hn::AllFalse(kTag, equal))) settle_ties(equal, first);
        if (hn::AllFalse(kTag, nearer)) return;
        m_counts.writes += hn::CountTrue(kTag, nearer);
        hn::BlendedStore(key, nearer, kTag, m_tile.key + first);
        hn::BlendedStore(hn::Set(kIdTag, m_target.id), hn::RebindMask(kIdTag, nearer), kIdTag,
                         m_tile.id + first);
    }

    /// One after another.
    template <std::size_t kMost>
    HWY_INLINE void record(const HitList<kMost>& hits, std::size_t count) {
        m_counts.hits += count;
        for (std::size_t i = 0; i < count; ++i) {
            const int slot = std::bit_cast<int>(hits.slot[i]);
            const float key = hits.key[i];
            float& stored = m_tile.key[slot];
            if (key < stored) continue;
            if (m_target.kind & kTransparent) {
                record_fragment(hits, i, slot);
            } else if (key > stored) {
                ++m_counts.writes;
                stored = key;
                m_tile.id[slot] = m_target.id;
            } else {
                settle_tie(m_tile.id[slot]);
            }
        }
    }

  private:
    HWY_NOINLINE void settle_ties(M equal, std::size_t first) {
        for_each_lane(equal, [&](int lane) { settle_tie(m_tile.id[first + lane]); });
    }

    HWY_INLINE void settle_tie(SurfaceId& id) {
        if (wins_tie(id)) id = m_target.id;
    }

    /// Where surfaces coincide, neighbours see the same two.
    HWY_INLINE bool wins_tie(SurfaceId id) {
        if (id == kNoSurface) return false;
        if (id != m_tied[0] || m_target.id != m_tied[1]) {
            m_tied[0] = id;
            m_tied[1] = m_target.id;
            m_wins_tie = m_grid.pool->before(m_target.id, id);
        }
        return m_wins_tie;
    }

    /// Hit i, if it is before the slot's opaque surface.
    template <std::size_t kMost>
    HWY_INLINE void record_fragment(const HitList<kMost>& hits, std::size_t i, std::size_t slot) {
        const float key = hits.key[i];
        if (!(key > m_tile.key[slot] || wins_tie(m_tile.id[slot]))) return;
        Fragment fragment;
        fragment.key = key;
        fragment.id = m_target.id;
        fragment.signed_b1 = hits.signed_b1[i];
        fragment.b2 = hits.b2[i];
        m_lists.add(static_cast<std::uint32_t>(slot), fragment);
        ++m_counts.fragments;
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
    const Target& m_target;
    FragmentLists& m_lists;
    SimdCounts& m_counts;
    SurfaceId m_tied[2] = {kNoSurface, kNoSurface};  ///< the last two to settle
    bool m_wins_tie = false;
};
