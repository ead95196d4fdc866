// SPDX-License-Identifier: GPL-3.0-or-later
// *Candidate samples*: those that micropolygons of grid parts and clusters are to be tested
// against. Included once a SIMD target inside its namespace, after stratum_windows.inl and
// shapes.inl.

/// Each sample with its own micropolygon and segment, so that vectors are full however few samples
/// a micropolygon has during a segment.
class CandidateSamples {
  public:
    static constexpr std::size_t kQueued = 256;
    static constexpr std::size_t kMost = kQueued + 2 * kPacket;

    /// The samples of the mask, each for the micropolygon in its lane: `index` in the grid,
    /// `corner` the vertex at the segment's begin.  full() must not hold.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void add(M mask, const Samples& at, V slots, hn::Vec<IntTag> index,
                        hn::Vec<IntTag> corner, V segment) {
        const Compact compact(mask);
        m_list.add<kMoving, kLens>(compact, at, slots, m_count);
        hn::StoreU(compact(hn::BitCast(kTag, index)), kTag, m_index + m_count);
        hn::StoreU(compact(hn::BitCast(kTag, corner)), kTag, m_corner + m_count);
        if constexpr (kMoving) hn::StoreU(compact(segment), kTag, m_segment + m_count);
        m_count += compact.count();
    }
    bool full() const { return m_count > kQueued; }
    std::size_t count() const { return m_count; }
    const SampleList<kMost>& list() const { return m_list; }

    /// The micropolygons of a vector of samples from i on, and their indices.
    template <bool kMoving>
    HWY_INLINE hn::Vec<IntTag> load_shapes(const SimdGrid& grid, std::size_t i, M valid,
                                           ShapeVector& shapes) const {
        const auto real = hn::RebindMask(kIntTag, valid);
        const auto load = [&](const float* bits) HWY_ATTR {
            return hn::IfThenElseZero(real, hn::BitCast(kIntTag, hn::LoadU(kTag, bits + i)));
        };
        const auto index = load(m_index);
        shapes.load<kMoving>(grid, index, load(m_corner), hn::LoadU(kTag, m_segment + i));
        return index;
    }

    void clear() { m_count = 0; }

  private:
    SampleList<kMost> m_list;
    float m_index[kMost], m_corner[kMost];  ///< bits of ints
    float m_segment[kMost];
    std::size_t m_count = 0;
};
