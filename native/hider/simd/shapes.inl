// SPDX-License-Identifier: GPL-3.0-or-later
// Micropolygons as they are tested: included once a SIMD target inside its namespace, after
// corner_arithmetic.inl and packet_vectors.inl.

HWY_INLINE Corner<V> from_to(const Corner<V>& a, const Corner<V>& b) {
    return {b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z};
}

/// A micropolygon during one segment of its motion.
struct Shape {
    Corner<float> begin[4], delta[4];
    int kinds;   ///< SimdGrid::classes
    int number;  ///< of the segment

    int kind(int) const { return kinds; }
    HWY_INLINE M lanes_with(int bit) const { return hn::FirstN(kTag, kinds & bit ? kPacket : 0); }
    HWY_INLINE V segment() const { return set(static_cast<float>(number)); }
    HWY_INLINE Corner<V> begin_of(int k) const { return broadcast(begin[k]); }
    HWY_INLINE Corner<V> delta_of(int k) const { return broadcast(delta[k]); }

  private:
    static HWY_INLINE Corner<V> broadcast(const Corner<float>& c) {
        return {set(c.x), set(c.y), set(c.w), set(c.z)};
    }
};

/// `vertex`: corner 0.
inline Shape load_shape(const SimdGrid& grid, int segment, int vertex, int kind) {
    const auto load = [&](int v, int knot) {
        const std::size_t i = static_cast<std::size_t>(knot) * grid.vertices + v;
        return Corner<float>{grid.x[i], grid.y[i], grid.w[i], grid.z[i]};
    };
    const int corner[4] = {vertex, vertex + grid.right, vertex + grid.right + grid.up,
                           vertex + grid.up};
    Shape shape;
    shape.kinds = kind;
    shape.number = segment;
    for (int k = 0; k < 4; ++k) {
        const Corner<float> a = shape.begin[k] = load(corner[k], segment);
        if (grid.segments == 0) continue;
        const Corner<float> b = load(corner[k], segment + 1);
        shape.delta[k] = {b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z};
    }
    return shape;
}

/// Four floats for each fourth of a vector's places, from the first on.
template <class D>
HWY_INLINE hn::Vec<D> load_fours(D d, const float* corners, const int* places) {
    if constexpr (hn::MaxLanes(d) == 4) {
        return hn::LoadU(d, corners + 4 * static_cast<std::ptrdiff_t>(*places));
    } else {
        constexpr hn::Half<D> half;
        return hn::Combine(d, load_fours(half, corners, places + hn::MaxLanes(half)),
                           load_fours(half, corners, places));
    }
}

/// Reads the corner at each of a vector's places: blocks of four are turned about.
HWY_INLINE Corner<V> load_corners(const float* corners, const int* places) {
    constexpr hn::Repartition<double, Tag> pairs;
    const V a = load_fours(kTag, corners, places), b = load_fours(kTag, corners, places + 1);
    const V c = load_fours(kTag, corners, places + 2), d = load_fours(kTag, corners, places + 3);
    const auto xy01 = hn::BitCast(pairs, hn::InterleaveLower(kTag, a, b));
    const auto wz01 = hn::BitCast(pairs, hn::InterleaveUpper(kTag, a, b));
    const auto xy23 = hn::BitCast(pairs, hn::InterleaveLower(kTag, c, d));
    const auto wz23 = hn::BitCast(pairs, hn::InterleaveUpper(kTag, c, d));
    return {hn::BitCast(kTag, hn::InterleaveLower(pairs, xy01, xy23)),
            hn::BitCast(kTag, hn::InterleaveUpper(pairs, xy01, xy23)),
            hn::BitCast(kTag, hn::InterleaveLower(pairs, wz01, wz23)),
            hn::BitCast(kTag, hn::InterleaveUpper(pairs, wz01, wz23))};
}

/// A micropolygon in each lane, each during a segment of its own.
class ShapeVector {
  public:
    /// By index in the grid and the vertex at the segment's begin.
    template <bool kMoving>
    HWY_INLINE void load(const SimdGrid& grid, hn::Vec<IntTag> index, hn::Vec<IntTag> vertex,
                         V segment) {
        alignas(64) int begin[kPacket];
        hn::Store(index, kIntTag, m_index);
        hn::Store(vertex, kIntTag, begin);
        m_grid = &grid;
        const int corner[4] = {0, grid.right, grid.right + grid.up, grid.up};
        for (int k = 0; k < 4; ++k) {
            const float* const from = grid.corners + 4 * static_cast<std::ptrdiff_t>(corner[k]);
            const Corner<V> here = load_corners(from, begin);
            store(here, m_begin[k]);
            if constexpr (kMoving) {
                const std::ptrdiff_t knot = 4 * static_cast<std::ptrdiff_t>(grid.vertices);
                store(from_to(here, load_corners(from + knot, begin)), m_delta[k]);
            }
        }
        hn::Store(segment, kTag, m_segment);
    }

    HWY_INLINE Corner<V> begin_of(int k) const { return corner_of(m_begin[k]); }
    HWY_INLINE Corner<V> delta_of(int k) const { return corner_of(m_delta[k]); }
    HWY_INLINE V segment() const { return hn::Load(kTag, m_segment); }

    /// SimdGrid::classes
    int kind(int lane) const { return m_grid->classes[m_index[lane]]; }

    /// The lanes of those whose kind has the bit.
    HWY_INLINE M lanes_with(int bit) const {
        if (HWY_LIKELY(m_grid->common & bit)) return hn::FirstN(kTag, kPacket);
        alignas(64) int kinds[kPacket];
        for (int lane = 0; lane < lane_count(); ++lane) kinds[lane] = kind(lane);
        return hn::RebindMask(kTag, hn::TestBit(hn::Load(kIntTag, kinds), hn::Set(kIntTag, bit)));
    }

  private:
    static HWY_INLINE void store(const Corner<V>& c, float (&to)[4][kPacket]) {
        hn::Store(c.x, kTag, to[0]);
        hn::Store(c.y, kTag, to[1]);
        hn::Store(c.w, kTag, to[2]);
        hn::Store(c.z, kTag, to[3]);
    }
    static HWY_INLINE Corner<V> corner_of(const float (&c)[4][kPacket]) {
        return {hn::Load(kTag, c[0]), hn::Load(kTag, c[1]), hn::Load(kTag, c[2]),
                hn::Load(kTag, c[3])};
    }

    // In memory: GCC moves structures of vectors in pieces, and each read of a whole one waits.
    alignas(64) float m_begin[4][4][kPacket], m_delta[4][4][kPacket], m_segment[kPacket];
    alignas(64) int m_index[kPacket];
    const SimdGrid* m_grid = nullptr;
};
