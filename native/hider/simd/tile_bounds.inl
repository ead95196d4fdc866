// SPDX-License-Identifier: GPL-3.0-or-later
// Where and when micropolygons can be in a tile: included once a SIMD target inside its namespace,
// like corner_arithmetic.inl, after the kernel's vector types.

/// Raster bounds, relative to the tile.
struct Box {
    V x_lo, x_hi, y_lo, y_hi;
};

/// Boxes that are not `sane` or too large for a number become all of the raster.
HWY_INLINE void widen_unknown(M sane, Box& box) {
    const V never = set(INFINITY);
    const V reach = hn::Abs(box.x_lo) + hn::Abs(box.x_hi) + hn::Abs(box.y_lo) + hn::Abs(box.y_hi);
    const M known = hn::And(sane, hn::Lt(reach, set(1e15f)));
    box.x_lo = hn::IfThenElse(known, box.x_lo, hn::Neg(never));
    box.x_hi = hn::IfThenElse(known, box.x_hi, never);
    box.y_lo = hn::IfThenElse(known, box.y_lo, hn::Neg(never));
    box.y_hi = hn::IfThenElse(known, box.y_hi, never);
}

/// The blocks of the tile that boxes touch, inclusive; which touch any.
template <class Out>
HWY_INLINE M store_blocks(const SimdTile& tile, const Box& box, Out& out) {
    const V scale = set(static_cast<float>(tile.blocks_wide) / kTileSize), zero = set(0.0f);
    const V last = set(static_cast<float>(tile.blocks_wide - 1));
    const V end = set(static_cast<float>(tile.blocks_wide));
    // Clamped before the conversion, which overflows otherwise.
    const V x0 = hn::Min(hn::Max(hn::Floor(box.x_lo * scale), zero), end);
    const V y0 = hn::Min(hn::Max(hn::Floor(box.y_lo * scale), zero), end);
    const V x1 = hn::Max(hn::Min(hn::Floor(box.x_hi * scale), last), set(-1.0f));
    const V y1 = hn::Max(hn::Min(hn::Floor(box.y_hi * scale), last), set(-1.0f));
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

/// Calls visit(i) for the vertices, at the begin of a segment, that are the corners of
/// micropolygons whose corner 0 is at `vertex`.
template <class Visit>
HWY_INLINE void for_each_corner(const SimdGrid& grid, int segment, int vertex, Visit visit) {
    const std::size_t first = static_cast<std::size_t>(segment) * grid.vertices + vertex;
    for (const int step : {0, grid.right, grid.up, grid.up + grid.right})
        visit(first + static_cast<std::size_t>(step));
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
    HWY_INLINE M find(const SimdGrid& grid, int segment, V& first, V& last) const {
        const V t0 = hn::Max(hn::Max(m_from[0], m_from[1]), hn::Max(m_from[2], m_from[3]));
        const V t1 = hn::Min(hn::Min(m_to[0], m_to[1]), hn::Min(m_to[2], m_to[3]));
        const V widen = set(0x1p-18f), start = set(static_cast<float>(segment));
        const V scale = set(1.0f / static_cast<float>(grid.segments));
        first = hn::Max((start + t0 - widen) * scale - widen, set(grid.lifespan.open));
        last = hn::Min((start + t1 + widen) * scale + widen, set(grid.lifespan.close));
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

/// When the micropolygons whose corner 0 is at `vertex` are over the tile, and which are at all.
template <Lens kLens>
HWY_INLINE M find_times(const SimdGrid& grid, int segment, int vertex, V& first, V& last) {
    TimesOverTile times;
    for_each_corner(grid, segment, vertex, [&](std::size_t i) HWY_ATTR {
        times.add<kLens>(grid, load_corner(grid, i),
                         load_corner(grid, i + static_cast<std::size_t>(grid.vertices)));
    });
    return times.find(grid, segment, first, last);
}
