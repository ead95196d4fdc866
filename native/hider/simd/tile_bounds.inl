// SPDX-License-Identifier: GPL-3.0-or-later
// Where micropolygons can be in a tile: included once a SIMD target inside its namespace, like
// corner_arithmetic.inl, after the kernel's vector types.

/// Rectangles of blocks, inclusive, and nearest keys, a vector of them.
struct BlockRanges {
    alignas(64) int x0[kPacket], x1[kPacket], y0[kPacket], y1[kPacket];
    alignas(64) float nearest[kPacket];
    alignas(64) float t0[kPacket], t1[kPacket];  ///< shutter times over the tile; moving only
};

/// Raster bounds -> blocks; which of them are in the tile.
template <class Out>
HWY_INLINE M store_blocks(const SimdTile& tile, V x_lo, V x_hi, V y_lo, V y_hi, Out& out) {
    const V scale = set(static_cast<float>(tile.blocks_wide) / kTileSize), zero = set(0.0f);
    const V last = set(static_cast<float>(tile.blocks_wide - 1));
    const V end = set(static_cast<float>(tile.blocks_wide));
    // Clamped before the conversion, which overflows otherwise.
    const V x0 = hn::Min(hn::Max(hn::Floor(x_lo * scale), zero), end);
    const V y0 = hn::Min(hn::Max(hn::Floor(y_lo * scale), zero), end);
    const V x1 = hn::Max(hn::Min(hn::Floor(x_hi * scale), last), set(-1.0f));
    const V y1 = hn::Max(hn::Min(hn::Floor(y_hi * scale), last), set(-1.0f));
    hn::StoreU(hn::ConvertTo(kIntTag, x0), kIntTag, out.x0);
    hn::StoreU(hn::ConvertTo(kIntTag, x1), kIntTag, out.x1);
    hn::StoreU(hn::ConvertTo(kIntTag, y0), kIntTag, out.y0);
    hn::StoreU(hn::ConvertTo(kIntTag, y1), kIntTag, out.y1);
    return hn::And(hn::Le(x0, x1), hn::Le(y0, y1));
}

/// The corners of micropolygons from a vertex on at a knot.
HWY_INLINE Corner<V> load_corner(const SimdGrid& grid, std::size_t i) {
    return {hn::LoadU(kTag, grid.x + i), hn::LoadU(kTag, grid.y + i), hn::LoadU(kTag, grid.w + i),
            hn::LoadU(kTag, grid.z + i)};
}

/// When what has these corners is over a tile during a segment: some corner right of its left side,
/// some corner left of its right side, and so on.  Each condition is linear in time for every
/// corner, whatever the sign of w (Laine et al. 2011).
class TimesOverTile {
  public:
    HWY_INLINE TimesOverTile() {
        for (V& t : m_from) t = set(INFINITY);
        for (V& t : m_to) t = set(-INFINITY);
    }

    template <Lens kLens>
    HWY_INLINE void add(const SimdGrid& grid, const Corner<V>& a, const Corner<V>& b) {
        V shear = set(0.0f);
        if constexpr (kLens != Lens::None) {
            const auto at = [&](float inverse_focus) HWY_ATTR {
                const V focus = set(inverse_focus), one = set(1.0f);
                return hn::Max(hn::Abs(a.z * focus - one), hn::Abs(b.z * focus - one));
            };
            shear = at(grid.inverse_focus);
            if constexpr (kLens == Lens::Refocused)
                shear = hn::Max(shear, at(grid.inverse_farthest));
            shear = shear * set(1.0f + 0x1p-18f);
        }
        const V side = set(static_cast<float>(kTileSize));
        const V base = hn::Max(hn::Abs(a.w), hn::Abs(b.w)) * set(1.0f / 256);
        const auto extend_axis = [&](V p0, V p1, float lens, int axis) HWY_ATTR {
            const V margin =
                base + hn::Max(hn::Abs(p0), hn::Abs(p1)) * set(0x1p-20f) + set(lens) * shear;
            extend(p0 + margin, p1 + margin, m_from[axis], m_to[axis]);
            extend(side * a.w - p0 + margin, side * b.w - p1 + margin, m_from[axis + 1],
                   m_to[axis + 1]);
        };
        extend_axis(a.x, b.x, grid.lens_x, 0);
        extend_axis(a.y, b.y, grid.lens_y, 2);
    }

    /// All lanes are of one thing.
    HWY_INLINE void reduce() {
        for (V& t : m_from) t = hn::MinOfLanes(kTag, t);
        for (V& t : m_to) t = hn::MaxOfLanes(kTag, t);
    }

    /// Times of the shutter; which there are.
    HWY_INLINE M store(const SimdGrid& grid, int segment, BlockRanges& out) const {
        const V t0 = hn::Max(hn::Max(m_from[0], m_from[1]), hn::Max(m_from[2], m_from[3]));
        const V t1 = hn::Min(hn::Min(m_to[0], m_to[1]), hn::Min(m_to[2], m_to[3]));
        const V widen = set(0x1p-18f), start = set(static_cast<float>(segment));
        const V scale = set(1.0f / static_cast<float>(grid.segments));
        const V first = hn::Max((start + t0 - widen) * scale - widen, set(grid.lifespan.open));
        const V last = hn::Min((start + t1 + widen) * scale + widen, set(grid.lifespan.close));
        hn::StoreU(first, kTag, out.t0);
        hn::StoreU(last, kTag, out.t1);
        return hn::And(hn::Le(t0, t1 + widen), hn::Le(first, last));
    }

  private:
    /// Grows [from, to] by the part of [0, 1] where the linear function with these end values is
    /// not negative.
    static HWY_INLINE void extend(V f0, V f1, V& from, V& to) {
        const V zero = set(0.0f), one = set(1.0f), never = set(INFINITY);
        const V root = f0 / (f0 - f1);
        const M in0 = hn::Ge(f0, zero), in1 = hn::Ge(f1, zero);
        from = hn::Min(from, hn::IfThenElse(in0, zero, hn::IfThenElse(in1, root, never)));
        to = hn::Max(to, hn::IfThenElse(in1, one, hn::IfThenElse(in0, root, hn::Neg(never))));
    }

    V m_from[4], m_to[4];
};

/// The micropolygons of a grid during one segment of its motion, over the blocks of a tile.
class TileBounds {
  public:
    TileBounds(const SimdGrid& grid, const SimdTile& tile) : m_grid(grid), m_tile(tile) {}

    Shape load_shape(int segment, int vertex, int kind) const {
        const int corner[4] = {vertex, vertex + m_grid.right, vertex + m_grid.right + m_grid.up,
                               vertex + m_grid.up};
        Shape shape;
        shape.kind = kind;
        shape.number = segment;
        for (int k = 0; k < 4; ++k) {
            shape.begin[k] = load(corner[k], segment);
            if (m_grid.segments == 0) continue;
            const Corner<float> a = shape.begin[k], b = load(corner[k], segment + 1);
            shape.delta[k] = {b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z};
        }
        return shape;
    }

    /// Of the micropolygons from this vertex on, which touch the tile, and where over the whole
    /// segment and lens.
    HWY_INLINE M find_touched(int segment, int vertex, int count, BlockRanges& out) const {
        const std::size_t at = static_cast<std::size_t>(segment) * m_grid.vertices + vertex;
        const std::size_t right = static_cast<std::size_t>(m_grid.right);
        const std::size_t above = at + static_cast<std::size_t>(m_grid.up);
        const auto least = [&](const float* a) HWY_ATTR {
            return hn::Min(hn::Min(hn::LoadU(kTag, a + at), hn::LoadU(kTag, a + at + right)),
                           hn::Min(hn::LoadU(kTag, a + above), hn::LoadU(kTag, a + above + right)));
        };
        const auto most = [&](const float* a) HWY_ATTR {
            return hn::Max(hn::Max(hn::LoadU(kTag, a + at), hn::LoadU(kTag, a + at + right)),
                           hn::Max(hn::LoadU(kTag, a + above), hn::LoadU(kTag, a + above + right)));
        };
        hn::StoreU(most(m_grid.nearest), kTag, out.nearest);
        const V left = set(m_grid.origin_x), bottom = set(m_grid.origin_y);
        const M some = store_blocks(m_tile, least(m_grid.x_lo) - left, most(m_grid.x_hi) - left,
                                    least(m_grid.y_lo) - bottom, most(m_grid.y_hi) - bottom, out);
        return hn::And(some, hn::FirstN(kTag, static_cast<std::size_t>(count)));
    }

    /// When they are over the tile, and which are at all.
    template <Lens kLens>
    HWY_INLINE M find_times(int segment, int vertex, BlockRanges& out) const {
        const std::size_t knot = static_cast<std::size_t>(segment) * m_grid.vertices;
        TimesOverTile times;
        for (const int corner : {vertex, vertex + m_grid.right, vertex + m_grid.up,
                                 vertex + m_grid.up + m_grid.right}) {
            const std::size_t a = knot + static_cast<std::size_t>(corner);
            times.add<kLens>(m_grid, load_corner(m_grid, a),
                             load_corner(m_grid, a + static_cast<std::size_t>(m_grid.vertices)));
        }
        return times.store(m_grid, segment, out);
    }

    /// Ranks [first, end) may look while the micropolygon is over the tile; `lane` of the last
    /// find_times().
    void find_ranks(const BlockRanges& times, int lane, int& first, int& end) const {
        const auto slab = [](float t) {
            constexpr int kSlabs = RankBounds::kSlabs;
            return static_cast<int>(
                std::min(std::max(t * static_cast<float>(kSlabs), 0.0f), kSlabs - 1.0f));
        };
        first = m_tile.bounds->first[slab(times.t0[lane])];
        end = m_tile.bounds->end[slab(times.t1[lane])];
    }

  private:
    Corner<float> load(int vertex, int knot) const {
        const std::size_t i = static_cast<std::size_t>(knot) * m_grid.vertices + vertex;
        return {m_grid.x[i], m_grid.y[i], m_grid.w[i], m_grid.z[i]};
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
};
