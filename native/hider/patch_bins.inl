// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of a tile by the micropolygons of a patch: included once a SIMD target inside its
// namespace, after rank_windows.inl and patch_frame.inl.

class PatchBins {
  public:
    static constexpr std::size_t kBin = 32;  ///< samples
    static constexpr int kBins = Patch::kSide * Patch::kSide;
    using List = SampleList<kBin>;

    /// The samples of the mask, each to bin `i` + kSide `j`; full() must not hold.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void add(M mask, const Samples& at, V slots, V i, V j) {
        const Squeeze squeeze(mask);
        m_queue.add<kMoving, kLens>(squeeze, at, slots, m_queued);
        const auto bin = hn::ConvertTo(kIntTag, i + j * set(static_cast<float>(Patch::kSide)));
        hn::StoreU(squeeze(hn::BitCast(kTag, bin)), kTag, m_bin + m_queued);
        m_queued += squeeze.count();
    }
    bool full() const { return m_queued > kQueued; }

    /// Puts what was added into its bins; calls empty(bin, list, count) for those that are full.
    template <bool kMoving, Lens kLens, class Empty>
    HWY_INLINE void distribute(Empty empty) {
        for (std::size_t k = 0; k < m_queued; ++k) {
            const int bin = std::bit_cast<int>(m_bin[k]);
            List& list = m_lists[bin];
            const std::size_t n = m_count[bin];
            list.samples[0][n] = m_queue.samples[0][k];
            list.samples[1][n] = m_queue.samples[1][k];
            if constexpr (kMoving) list.samples[2][n] = m_queue.samples[2][k];
            if constexpr (kLens != Lens::None) {
                list.samples[3][n] = m_queue.samples[3][k];
                list.samples[4][n] = m_queue.samples[4][k];
            }
            if constexpr (kLens == Lens::Refocused) list.samples[5][n] = m_queue.samples[5][k];
            list.slot[n] = m_queue.slot[k];
            m_count[bin] = static_cast<std::uint32_t>(n + 1);
            if (n + 1 == kBin) {
                empty(bin, list, kBin);
                m_count[bin] = 0;
            }
        }
        m_queued = 0;
    }
    /// The same for all that are not empty.
    template <class Empty>
    HWY_INLINE void empty_all(Empty empty) {
        for (int bin = 0; bin < kBins; ++bin) {
            if (m_count[bin] == 0) continue;
            empty(bin, m_lists[bin], m_count[bin]);
            m_count[bin] = 0;
        }
    }

  private:
    static constexpr std::size_t kQueued = 256;
    /// A vector of samples is added to four bins each at most.
    static constexpr std::size_t kSpare = 5 * kPacket;

    SampleList<kQueued + kSpare> m_queue;
    float m_bin[kQueued + kSpare];  ///< bits of an int
    std::size_t m_queued = 0;
    List m_lists[kBins];
    std::uint32_t m_count[kBins] = {};
};
