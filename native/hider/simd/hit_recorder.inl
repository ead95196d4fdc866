// SPDX-License-Identifier: GPL-3.0-or-later
// What the samples that a micropolygon covers see: included once a SIMD target inside its
// namespace, after sample_test.inl and vector_fragments.inl.

/// Hits in different slots, in the order in which they came.
template <std::size_t kMost>
struct HitList {
    float key[kMost], signed_b1[kMost], b2[kMost];
    float slot[kMost], id[kMost];  ///< bits of an int and of a SurfaceId
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
                    wins[lane] = wins_tie(m_target.id, m_tile.id[first + lane]) ? 1.0f : 0.0f;
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
        const bool some_transparent = m_target.kind & kTransparent;
        for (std::size_t i = 0; i < count; ++i) {
            const int slot = std::bit_cast<int>(hits.slot[i]);
            const float key = hits.key[i];
            float& stored = m_tile.key[slot];
            if (key < stored) continue;
            const auto id = std::bit_cast<SurfaceId>(hits.id[i]);
            if (some_transparent && m_grid.classes[id - m_grid.base] & kTransparent) {
                if (key > stored || wins_tie(id, m_tile.id[slot])) {
                    Fragment fragment;
                    fragment.key = key;
                    fragment.id = id;
                    fragment.signed_b1 = hits.signed_b1[i];
                    fragment.b2 = hits.b2[i];
                    m_lists.add(static_cast<std::uint32_t>(slot), fragment);
                    ++m_counts.fragments;
                }
            } else if (key > stored) {
                ++m_counts.writes;
                stored = key;
                m_tile.id[slot] = id;
            } else if (wins_tie(id, m_tile.id[slot])) {
                m_tile.id[slot] = id;
            }
        }
    }

  private:
    HWY_NOINLINE void settle_ties(M equal, std::size_t first) {
        for_each_lane(equal, [&](int lane) {
            SurfaceId& other = m_tile.id[first + lane];
            if (wins_tie(m_target.id, other)) other = m_target.id;
        });
    }

    /// Where surfaces coincide, neighbours see the same two.
    HWY_INLINE bool wins_tie(SurfaceId id, SurfaceId other) {
        if (other == kNoSurface) return false;
        if (other != m_tied[0] || id != m_tied[1]) {
            m_tied[0] = other;
            m_tied[1] = id;
            m_wins_tie = m_grid.pool->before(id, other);
        }
        return m_wins_tie;
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
    const Target& m_target;
    FragmentLists& m_lists;
    SimdCounts& m_counts;
    SurfaceId m_tied[2] = {kNoSurface, kNoSurface};  ///< the last two to settle
    bool m_wins_tie = false;
};
