// SPDX-License-Identifier: GPL-3.0-or-later
// Micropolygons as they are tested: included once a SIMD target inside its namespace, after
// corner_arithmetic.inl and packet_vectors.inl.

/// A micropolygon during one segment of its motion.
struct Shape {
    Corner<float> begin[4], delta[4];
    int kind;  ///< SimdGrid::classes

    HWY_INLINE Corner<V> begin_of(int k) const { return broadcast(begin[k]); }
    HWY_INLINE Corner<V> delta_of(int k) const { return broadcast(delta[k]); }

  private:
    static HWY_INLINE Corner<V> broadcast(const Corner<float>& c) {
        return {set(c.x), set(c.y), set(c.w), set(c.z)};
    }
};

/// Micropolygons side by side: lane l of a vector is of number l % kWide.
class ShapeRow {
  public:
    static constexpr int kWide = 4;

    /// From the one with corner 0 at `vertex` on.
    template <bool kMoving>
    HWY_INLINE void load(const SimdGrid& grid, int segment, int vertex) {
        constexpr hn::CappedTag<float, kWide> row;
        const int corner[4] = {vertex, vertex + grid.right, vertex + grid.right + grid.up,
                               vertex + grid.up};
        const float* const from[4] = {grid.x, grid.y, grid.w, grid.z};
        for (int k = 0; k < 4; ++k)
            for (int c = 0; c < 4; ++c) {
                const float* const at =
                    from[c] + static_cast<std::size_t>(segment) * grid.vertices + corner[k];
                const auto begin = hn::LoadU(row, at);
                hn::Store(begin, row, m_begin[k][c]);
                if constexpr (kMoving)
                    hn::Store(hn::LoadU(row, at + grid.vertices) - begin, row, m_delta[k][c]);
            }
    }

    HWY_INLINE Corner<V> begin_of(int k) const { return repeat(m_begin[k]); }
    HWY_INLINE Corner<V> delta_of(int k) const { return repeat(m_delta[k]); }

    /// SimdGrid::classes; 0 where there is none.
    alignas(16) int kind[kWide];

    /// The lanes of those whose kind has the bit.
    HWY_INLINE M lanes_with(int bit) const {
        const auto kinds = hn::LoadDup128(kIntTag, kind);
        return hn::RebindMask(kTag, hn::TestBit(kinds, hn::Set(kIntTag, bit)));
    }

  private:
    static HWY_INLINE Corner<V> repeat(const float (&c)[4][kWide]) {
        return {hn::LoadDup128(kTag, c[0]), hn::LoadDup128(kTag, c[1]), hn::LoadDup128(kTag, c[2]),
                hn::LoadDup128(kTag, c[3])};
    }

    alignas(16) float m_begin[4][4][kWide], m_delta[4][4][kWide];  ///< [corner][x, y, w, z]
};
