// SPDX-License-Identifier: GPL-3.0-or-later
// Where a micropolygon is while the samples of strata look: included once a SIMD target inside its
// namespace, after swept_bounds.inl and tile_bounds.inl.

/// Where a micropolygon is while the samples of a stratum look, a vector of strata.
struct StratumPaths {
    alignas(64) int x0[kPacket], x1[kPacket], y0[kPacket], y1[kPacket];  ///< blocks, inclusive
    /// On an axis: it stays within `reach` of place + speed t + shear u for a sample's t and u;
    /// where samples have a focus each, of place + speed t + (shear + depth / focus) u.
    struct Axis {
        alignas(64) float place[kPacket], speed[kPacket], reach[kPacket];
    } x, y;
    alignas(64) float shear[kPacket], depth[kPacket];
};

/// Where micropolygons go while they are over a tile, a vector of them: a stratum's samples see a
/// part of that path.
struct TilePaths {
    struct Axis {
        alignas(64) float place[kPacket], speed[kPacket], reach[kPacket];  ///< StraightPath
    } x, y;
    /// LensExtents, as far as the lens has them.
    alignas(64) float shear_lo[kPacket], shear_hi[kPacket], depth_lo[kPacket], depth_hi[kPacket],
        reciprocal_lo[kPacket], reciprocal_hi[kPacket];
    alignas(64) float nearest[kPacket];          ///< no sample sees a nearer key
    alignas(64) float t0[kPacket], t1[kPacket];  ///< shutter times over the tile; moving only
    /// Blocks, inclusive; of what does not move.
    alignas(64) int x0[kPacket], x1[kPacket], y0[kPacket], y1[kPacket];
    std::uint32_t straight = 0;  ///< bit i: micropolygon i stays that near to one line
};

/// When something is over a tile, during a segment.
template <bool kMoving>
struct SegmentPart {
    V ends[2];       ///< in parts of the segment
    V time0, time1;  ///< of the shutter

    HWY_INLINE SegmentPart(const SimdGrid& grid, int segment, V first, V last) {
        const V zero = set(0.0f), one = set(1.0f);
        const V knots = set(static_cast<float>(std::max(1, grid.segments)));
        const V start = set(static_cast<float>(segment));
        ends[0] = ends[1] = zero;
        if constexpr (kMoving) {
            ends[0] = hn::Min(hn::Max(first * knots - start, zero), one);
            ends[1] = hn::Max(ends[0], hn::Min(hn::Max(last * knots - start, zero), one));
        }
        time0 = (ends[0] + start) / knots;
        time1 = (ends[1] + start) / knots;
    }
};

/// A grid over the strata of a tile.
class StratumPathFinder {
  public:
    /// Squares of the hierarchical depth in a row that are looked at: what a micropolygon needs,
    /// and all that a tile has.
    static constexpr int kFewSquares = 2, kAllSquares = 4;

    StratumPathFinder(const SimdGrid& grid, const SimdTile& tile) : m_grid(grid), m_tile(tile) {}

    /// The micropolygons whose corner 0 is at `vertex`, all of which are over the tile when `part`
    /// says: their corners.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void add_corners(int segment, int vertex, const SegmentPart<kMoving>& part,
                                SweptBounds<kMoving, kLens>& to) const {
        for_each_corner(m_grid, segment, vertex, [&](std::size_t i) HWY_ATTR {
            const Corner<V> begin = load_corner(m_grid, i);
            Corner<V> delta = begin;
            if constexpr (kMoving)
                delta = from_to(begin,
                                load_corner(m_grid, i + static_cast<std::size_t>(m_grid.vertices)));
            to.add(m_grid, begin, delta, part.ends);
        });
    }

    /// The paths of micropolygons, and which of `present` are over the tile.
    template <bool kMoving, Lens kLens>
    HWY_INLINE M find_paths(int segment, int vertex, M present, TilePaths& out) const {
        V first = set(0.0f), last = first;
        if constexpr (kMoving) {
            present = hn::And(present, find_times<kLens>(m_grid, segment, vertex, first, last));
            if (hn::AllFalse(kTag, present)) return present;
        }
        const SegmentPart<kMoving> part(m_grid, segment, first, last);
        SweptBounds<kMoving, kLens> extents(hn::FirstN(kTag, kPacket));
        add_corners(segment, vertex, part, extents);
        store_paths(extents, part, out);
        if constexpr (kMoving) {
            hn::StoreU(first, kTag, out.t0);
            hn::StoreU(last, kTag, out.t1);
            return present;
        }
        return hn::And(present, find_touching(extents, out));
    }

    /// Which of those that do not move touch the tile, and which blocks.
    template <bool kMoving, Lens kLens, class Out>
    HWY_INLINE M find_touching(const SweptBounds<kMoving, kLens>& extents, Out& out) const {
        Box box = extents.box();
        if constexpr (kLens != Lens::None) {
            const Shear shear = shear_of<kLens>(extents.lens, set(m_grid.inverse_farthest),
                                                set(m_grid.inverse_focus));
            const V u = set(m_grid.lens_x), v = set(m_grid.lens_y);
            add_lens(shear, hn::Neg(u), u, box.x_lo, box.x_hi);
            add_lens(shear, hn::Neg(v), v, box.y_lo, box.y_hi);
        }
        widen_unknown(extents.sane, box);
        return store_blocks(m_tile, box, out);
    }

    /// Of what has these extents, a vector of things.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void store_paths(const SweptBounds<kMoving, kLens>& extents,
                                const SegmentPart<kMoving>& part, TilePaths& out) const {
        M straight = extents.sane;
        const auto axis = [&](const Extent& at, V bend, TilePaths::Axis& to) HWY_ATTR {
            const StraightPath path = extents.straight(at, bend, part.time0, part.time1);
            const V reach = path.reach + extents.margin;
            straight = hn::And(straight, hn::And(hn::Le(bend, set(kMostBend)),
                                                 hn::Lt(hn::Abs(path.place) + reach, set(1e15f))));
            hn::StoreU(path.place, kTag, to.place);
            hn::StoreU(path.speed, kTag, to.speed);
            hn::StoreU(reach, kTag, to.reach);
        };
        axis(extents.x, extents.bend_x, out.x);
        axis(extents.y, extents.bend_y, out.y);
        if constexpr (kLens == Lens::Still) {
            hn::StoreU(extents.lens.shear.lo[0], kTag, out.shear_lo);
            hn::StoreU(extents.lens.shear.hi[0], kTag, out.shear_hi);
        }
        if constexpr (kLens == Lens::Refocused) {
            hn::StoreU(extents.lens.depth.lo[0], kTag, out.depth_lo);
            hn::StoreU(extents.lens.depth.hi[0], kTag, out.depth_hi);
            hn::StoreU(extents.lens.reciprocal.lo[0], kTag, out.reciprocal_lo);
            hn::StoreU(extents.lens.reciprocal.hi[0], kTag, out.reciprocal_hi);
        }
        hn::StoreU(extents.nearest_key(m_grid.range.perspective), kTag, out.nearest);
        out.straight = bits_of(straight);
    }

    /// The part of a straight path, `lane` of find_paths(), that the samples of each of these
    /// strata can see, and which of the strata have any that do not see something nearer.
    template <bool kMoving, Lens kLens, int kSquares = kFewSquares>
    HWY_INLINE M follow(const TilePaths& paths, int lane, int segment, int first, bool cull,
                        StratumPaths& out) const {
        const StratumBounds& bounds = *m_tile.bounds;
        const V t_lo = stratum(bounds.t_lo, first), t_hi = stratum(bounds.t_hi, first);
        M present = hn::Le(t_lo, t_hi);
        if constexpr (kMoving) present = hn::And(present, in_segment(t_lo, t_hi, segment));
        LensExtents lens;
        if constexpr (kLens == Lens::Still) {
            lens.shear.lo[0] = set(paths.shear_lo[lane]);
            lens.shear.hi[0] = set(paths.shear_hi[lane]);
        }
        if constexpr (kLens == Lens::Refocused) {
            lens.depth.lo[0] = set(paths.depth_lo[lane]);
            lens.depth.hi[0] = set(paths.depth_hi[lane]);
            lens.reciprocal.lo[0] = set(paths.reciprocal_lo[lane]);
            lens.reciprocal.hi[0] = set(paths.reciprocal_hi[lane]);
        }
        const Shear shear = shear_of<kLens>(lens, first);
        Box box;
        const auto axis = [&](const TilePaths::Axis& path, const std::vector<float>& lens_lo,
                              const std::vector<float>& lens_hi, StratumPaths::Axis& to, V& lo,
                              V& hi) HWY_ATTR {
            const V place = set(path.place[lane]), speed = set(path.speed[lane]);
            V reach = set(path.reach[lane]), a = place, b = place;
            if constexpr (kMoving) {
                a = place + speed * t_lo;
                b = place + speed * t_hi;
                hn::StoreU(speed, kTag, to.speed);
            }
            lo = hn::Min(a, b) - reach;
            hi = hn::Max(a, b) + reach;
            if constexpr (kLens != Lens::None) {
                const V u_lo = stratum(lens_lo, first), u_hi = stratum(lens_hi, first);
                add_lens(shear, u_lo, u_hi, lo, hi);
                reach = reach + lens_rest(shear, u_lo, u_hi);
            }
            hn::StoreU(place, kTag, to.place);
            hn::StoreU(reach, kTag, to.reach);
        };
        axis(paths.x, bounds.u_lo, bounds.u_hi, out.x, box.x_lo, box.x_hi);
        axis(paths.y, bounds.v_lo, bounds.v_hi, out.y, box.y_lo, box.y_hi);
        store_shear<kLens>(shear, present, out);
        return find_blocks<kSquares>(present, box, set(paths.nearest[lane]), first, cull, out);
    }

    /// The same by where the micropolygon is during each of the strata: for paths that are bent.
    template <bool kMoving, Lens kLens>
    HWY_INLINE M find(const Shape& shape, int segment, int first, bool cull,
                      StratumPaths& out) const {
        const StratumBounds& bounds = *m_tile.bounds;
        const V zero = set(0.0f), one = set(1.0f);
        const V t_lo = stratum(bounds.t_lo, first), t_hi = stratum(bounds.t_hi, first);
        M present = hn::Le(t_lo, t_hi);
        const V knots = set(static_cast<float>(std::max(1, m_grid.segments)));
        const V start = set(static_cast<float>(segment));
        V ends[2] = {zero, zero};
        if constexpr (kMoving) {
            present = hn::And(present, in_segment(t_lo, t_hi, segment));
            ends[0] = hn::Max(t_lo * knots - start, zero);
            ends[1] = hn::Min(t_hi * knots - start, one);
        }
        SweptBounds<kMoving, kLens> extents(present);
        for (int k = 0; k < 4; ++k) extents.add(m_grid, shape.begin_of(k), shape.delta_of(k), ends);
        const V time0 = (ends[0] + start) / knots, time1 = (ends[1] + start) / knots;
        const Shear shear = shear_of<kLens>(extents.lens, first);
        Box box = extents.box();
        if constexpr (kLens != Lens::None) {
            add_lens(shear, stratum(bounds.u_lo, first), stratum(bounds.u_hi, first), box.x_lo,
                     box.x_hi);
            add_lens(shear, stratum(bounds.v_lo, first), stratum(bounds.v_hi, first), box.y_lo,
                     box.y_hi);
        }
        // At or behind the eye plane: anywhere.
        const M known = widen_unknown(extents.sane, box);
        const auto axis = [&](const Extent& at, V bend, const std::vector<float>& lens_lo,
                              const std::vector<float>& lens_hi, StratumPaths::Axis& to) HWY_ATTR {
            const StraightPath path = extents.straight(at, bend, time0, time1);
            V reach = path.reach + extents.margin;
            if constexpr (kLens != Lens::None)
                reach = reach + lens_rest(shear, stratum(lens_lo, first), stratum(lens_hi, first));
            if constexpr (kMoving)
                hn::StoreU(hn::IfThenElseZero(known, path.speed), kTag, to.speed);
            hn::StoreU(hn::IfThenElseZero(known, path.place), kTag, to.place);
            hn::StoreU(hn::IfThenElse(known, reach, set(INFINITY)), kTag, to.reach);
        };
        axis(extents.x, extents.bend_x, bounds.u_lo, bounds.u_hi, out.x);
        axis(extents.y, extents.bend_y, bounds.v_lo, bounds.v_hi, out.y);
        store_shear<kLens>(shear, known, out);
        return find_blocks<kFewSquares>(present, box, extents.nearest_key(m_grid.range.perspective),
                                        first, cull, out);
    }

    /// Strata [first, end) may look while the micropolygon of this lane is over the tile.
    void find_strata(const TilePaths& paths, int lane, int& first, int& end) const {
        const auto slab = [](float t) {
            constexpr int kSlabs = StratumBounds::kSlabs;
            return static_cast<int>(
                std::min(std::max(t * static_cast<float>(kSlabs), 0.0f), kSlabs - 1.0f));
        };
        first = m_tile.bounds->first[slab(paths.t0[lane])];
        end = m_tile.bounds->end[slab(paths.t1[lane])];
    }

    /// What a lens coordinate of 1 shifts by: from lo to hi, and within `rest` of middle + depth /
    /// focus for a sample's own focus, of which 1 / focus is from far to near.
    struct Shear {
        V lo, hi, middle, depth, rest;
    };
    template <Lens kLens>
    static HWY_INLINE Shear shear_of(const LensExtents& lens, V far, V near) {
        const V zero = set(0.0f), half = set(0.5f), rounding = set(0x1p-20f);
        if constexpr (kLens == Lens::None) return {zero, zero, zero, zero, zero};
        if constexpr (kLens == Lens::Still) {
            const V lo = lens.shear.lo[0], hi = lens.shear.hi[0], middle = (lo + hi) * half;
            return {lo, hi, middle, zero, (hi - lo) * half + hn::Abs(middle) * rounding};
        }
        const V d0 = lens.depth.lo[0], d1 = lens.depth.hi[0];
        const V r0 = lens.reciprocal.lo[0], r1 = lens.reciprocal.hi[0];
        Shear shear;
        shear.lo = hn::Min(hn::Min(d0 * far, d0 * near), hn::Min(d1 * far, d1 * near)) - r1;
        shear.hi = hn::Max(hn::Max(d0 * far, d0 * near), hn::Max(d1 * far, d1 * near)) - r0;
        shear.middle = hn::Neg((r0 + r1) * half);
        shear.depth = (d0 + d1) * half;
        shear.rest = (r1 - r0) * half + near * (d1 - d0) * half +
                     (hn::Abs(shear.middle) + near * hn::Abs(shear.depth)) * rounding;
        return shear;
    }

  private:
    /// Paths that bend more are looked at stratum by stratum, pixels.
    static constexpr float kMostBend = 0.125f;

    static HWY_INLINE V stratum(const std::vector<float>& values, int first) {
        return hn::LoadU(kTag, values.data() + first);
    }
    /// Which of these intervals of time touch the segment.
    HWY_INLINE M in_segment(V t_lo, V t_hi, int segment) const {
        const V knots = set(static_cast<float>(m_grid.segments));
        const V start = set(static_cast<float>(segment));
        return hn::And(hn::Ge(t_hi * knots - start, set(0.0f)),
                       hn::Le(t_lo * knots - start, set(1.0f)));
    }

    /// At the times of strata.
    template <Lens kLens>
    HWY_INLINE Shear shear_of(const LensExtents& lens, int first) const {
        V far = set(0.0f), near = far;
        if constexpr (kLens == Lens::Refocused) {
            far = stratum(m_tile.bounds->focus_lo, first);
            near = stratum(m_tile.bounds->focus_hi, first);
        }
        return shear_of<kLens>(lens, far, near);
    }

    /// Shears what is bounded by lens coordinates from u_lo to u_hi.
    static HWY_INLINE void add_lens(const Shear& shear, V u_lo, V u_hi, V& lo, V& hi) {
        const V a = shear.lo * u_lo, b = shear.lo * u_hi;
        const V c = shear.hi * u_lo, d = shear.hi * u_hi;
        lo = lo + hn::Min(hn::Min(a, b), hn::Min(c, d));
        hi = hi + hn::Max(hn::Max(a, b), hn::Max(c, d));
    }
    /// How far that may be from what a sample's own shear says.
    static HWY_INLINE V lens_rest(const Shear& shear, V u_lo, V u_hi) {
        return hn::Max(hn::Abs(u_lo), hn::Abs(u_hi)) * shear.rest;
    }

    /// 0 where not `known`.
    template <Lens kLens>
    static HWY_INLINE void store_shear(const Shear& shear, M known, StratumPaths& out) {
        if constexpr (kLens != Lens::None)
            hn::StoreU(hn::IfThenElseZero(known, shear.middle), kTag, out.shear);
        if constexpr (kLens == Lens::Refocused)
            hn::StoreU(hn::IfThenElseZero(known, shear.depth), kTag, out.depth);
    }

    template <int kSquares>
    HWY_INLINE M find_blocks(M present, const Box& box, V nearest, int first, bool cull,
                             StratumPaths& out) const {
        present = hn::And(present, store_blocks(m_tile, box, out));
        if (!cull || hn::AllFalse(kTag, present)) return present;
        return hn::AndNot(hidden<kSquares>(nearest, first, out), present);
    }

    /// Whether all samples of the blocks see something nearer, by the hierarchical depth of the
    /// strata; only where the blocks lie in at most kSquares by kSquares of its squares.
    template <int kSquares>
    HWY_INLINE M hidden(V nearest, int first, const StratumPaths& blocks) const {
        const auto square = [&](const int* block) HWY_ATTR {
            return hn::ShiftRightSame(hn::LoadU(kIntTag, block), m_tile.square_shift);
        };
        const auto x0 = square(blocks.x0), x1 = square(blocks.x1);
        const auto y0 = square(blocks.y0), y1 = square(blocks.y1);
        const auto most = hn::Set(kIntTag, kSquares);
        const auto few = hn::And(hn::Lt(x1 - x0, most), hn::Lt(y1 - y0, most));
        const auto wide = hn::Set(kIntTag, m_tile.squares_wide);
        const auto strata = hn::Set(kIntTag, m_tile.strata);
        // Lanes without blocks may lie outside.
        const auto safe = hn::Set(kIntTag, 0), last = wide - hn::Set(kIntTag, 1);
        V least = set(INFINITY);
        for (int j = 0; j < kSquares; ++j)
            for (int i = 0; i < kSquares; ++i) {
                auto x = hn::Min(x0 + hn::Set(kIntTag, i), x1);
                auto y = hn::Min(y0 + hn::Set(kIntTag, j), y1);
                x = hn::Min(hn::Max(x, safe), last);
                y = hn::Min(hn::Max(y, safe), last);
                least =
                    hn::Min(least, hn::GatherIndex(kTag, m_tile.farthest_of_strata + first,
                                                   (y * wide + x) * strata + hn::Iota(kIntTag, 0)));
            }
        return hn::And(hn::RebindMask(kTag, few), hn::Lt(nearest, least));
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
};
