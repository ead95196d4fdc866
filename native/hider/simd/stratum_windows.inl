// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of strata near to where something is: included once a SIMD target inside its namespace,
// after sample_packet.inl and tile_paths.inl.

/// Samples that are not neighbours in the tile, with their slots.
template <std::size_t kMost>
struct SampleList {
    alignas(64) float samples[Samples::kCoordinates][kMost], slot[kMost];  ///< bits of an int

    /// Appends the lanes of the mask, after `count`.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void add(const Compact& compact, Samples at, V slots, std::size_t count) {
        at.for_each<kMoving, kLens>(
            [&](V value, int k) HWY_ATTR { hn::StoreU(compact(value), kTag, samples[k] + count); });
        hn::StoreU(compact(slots), kTag, slot + count);
    }
    template <bool kMoving, Lens kLens>
    HWY_INLINE Samples load(std::size_t i) const {
        Samples at;
        at.for_each<kMoving, kLens>([&](V& value, int k)
                                        HWY_ATTR { value = hn::LoadU(kTag, samples[k] + i); });
        return at;
    }
};

/// Squares of four by four blocks of a stratum.
class StratumWindows {
  public:
    explicit StratumWindows(const SimdTile& tile) : m_tile(tile) {
        for (int i = 0; i < kPacket; ++i) m_slots[i] = i / kSide * tile.blocks_wide + i % kSide;
    }

    /// Calls visit(samples, their slots, how far they are on x and y from where the path is at
    /// their time and lens point) for the samples of the blocks of paths' lane k, of `stratum`, and
    /// some around them.
    template <bool kMoving, Lens kLens, class Visit>
    HWY_INLINE void visit(const StratumPaths& paths, int k, int stratum, Visit visit) const {
        // Windows side by side that do not leave the tile.
        const int wide = m_tile.blocks_wide;
        const int across = (paths.x1[k] - paths.x0[k]) / kSide + 1;
        const int up = (paths.y1[k] - paths.y0[k]) / kSide + 1;
        const int x0 = std::min(paths.x0[k], wide - kSide * across);
        const int y0 = std::min(paths.y0[k], wide - kSide * up);
        for (int y = 0; y < up; ++y)
            for (int x = 0; x < across; ++x)
                visit_window<kMoving, kLens>(
                    paths, k,
                    stratum * m_tile.stratum_stride + (y0 + kSide * y) * wide + x0 + kSide * x,
                    visit);
    }

  private:
    static constexpr int kSide = 4;

    /// Rows of kSide floats, as many as fit a vector.
    template <class D>
    HWY_INLINE hn::Vec<D> load_rows(D d, const float* row) const {
        if constexpr (hn::MaxLanes(d) == kSide) {
            return hn::LoadU(d, row);
        } else {
            constexpr hn::Half<D> half;
            constexpr int kRows = hn::MaxLanes(d) / kSide / 2;
            return hn::Combine(d, load_rows(half, row + kRows * m_tile.blocks_wide),
                               load_rows(half, row));
        }
    }

    template <bool kMoving, Lens kLens, class Visit>
    HWY_INLINE void visit_window(const StratumPaths& paths, int k, int slot, Visit visit) const {
        constexpr int kRows = hn::MaxLanes(kTag) / kSide;
        for (int row = 0; row < kSide; row += kRows, slot += kRows * m_tile.blocks_wide) {
            Samples at;
            at.x = load_rows(kTag, m_tile.x + slot);
            at.y = load_rows(kTag, m_tile.y + slot);
            V x = set(paths.x.place[k]), y = set(paths.y.place[k]);
            if constexpr (kMoving) {
                at.t = load_rows(kTag, m_tile.t + slot);
                x = x + set(paths.x.speed[k]) * at.t;
                y = y + set(paths.y.speed[k]) * at.t;
            }
            if constexpr (kLens != Lens::None) {
                at.u = load_rows(kTag, m_tile.u + slot);
                at.v = load_rows(kTag, m_tile.v + slot);
                V shear = set(paths.shear[k]);
                if constexpr (kLens == Lens::Refocused) {
                    at.inverse_focus = load_rows(kTag, m_tile.inverse_focus + slot);
                    shear = shear + set(paths.depth[k]) * at.inverse_focus;
                }
                x = x + shear * at.u;
                y = y + shear * at.v;
            }
            const auto slots = hn::LoadU(kIntTag, m_slots) + hn::Set(kIntTag, slot);
            visit(at, hn::BitCast(kTag, slots), at.x - x, at.y - y);
        }
    }

    const SimdTile& m_tile;
    alignas(64) int m_slots[kPacket];  ///< of a vector's rows, from the first
};
