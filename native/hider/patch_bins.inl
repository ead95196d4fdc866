// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of a tile by the micropolygons of a patch or flock: included once a SIMD target inside its
// namespace, after rank_windows.inl and patch_frame.inl.

/// Micropolygons of a row side by side share a list, so that one vector tests a few samples of each
/// (ShapeRow): where they move fast, a tile has few for each.
class PatchBins {
  public:
    static constexpr std::size_t kBin = 32;  ///< samples of a micropolygon
    static constexpr int kRow = ShapeRow::kWide;
    static constexpr int kRows = Patch::kSide * Patch::kSide / kRow;

    /// The samples of micropolygon i are at [kRow * n + i] for n < count[i].
    struct Row {
        SampleList<kBin * kRow> list;
        alignas(16) int count[kRow];
    };

    PatchBins() {
        for (Row& row : m_rows) std::fill_n(row.count, kRow, 0);
    }

    /// The samples of the mask, each with what tells its micropolygons; full() must not hold.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void add(M mask, const Samples& at, V slots, hn::Vec<IntTag> where) {
        const Squeeze squeeze(mask);
        m_queue.add<kMoving, kLens>(squeeze, at, slots, m_queued);
        hn::StoreU(squeeze(hn::BitCast(kTag, where)), kTag, m_where + m_queued);
        m_queued += squeeze.count();
    }
    bool full() const { return m_queued > kQueued; }

    /// Puts what was added into the lists of all micropolygons that for_each(where, visit) visits;
    /// calls test(number, row) for rows in which there is no more place, and empties them.
    template <bool kMoving, Lens kLens, class ForEach, class Test>
    HWY_INLINE void distribute(ForEach for_each, Test test) {
        for (std::size_t k = 0; k < m_queued; ++k)
            for_each(std::bit_cast<int>(m_where[k]), [&](int bin) HWY_ATTR {
                Row& row = m_rows[bin / kRow];
                int& count = row.count[bin % kRow];
                const int to = kRow * count + bin % kRow;
                for (int c = 0; c < Samples::kCoordinates; ++c)
                    if (Samples::has<kMoving, kLens>(c))
                        row.list.samples[c][to] = m_queue.samples[c][k];
                row.list.slot[to] = m_queue.slot[k];
                if (++count == kBin) empty(bin / kRow, test);
            });
        m_queued = 0;
    }
    /// The same for all that have any.
    template <class Test>
    HWY_INLINE void empty_all(Test test) {
        for (int number = 0; number < kRows; ++number) {
            const int* const count = m_rows[number].count;
            if (std::any_of(count, count + kRow, [](int n) { return n > 0; })) empty(number, test);
        }
    }

  private:
    template <class Test>
    HWY_INLINE void empty(int number, Test test) {
        test(number, m_rows[number]);
        std::fill_n(m_rows[number].count, kRow, 0);
    }

    static constexpr std::size_t kQueued = 256;
    /// A vector of samples is added to four micropolygons each at most.
    static constexpr std::size_t kSpare = 5 * kPacket;

    SampleList<kQueued + kSpare> m_queue;
    float m_where[kQueued + kSpare];  ///< bits of an int
    std::size_t m_queued = 0;
    Row m_rows[kRows];
};
