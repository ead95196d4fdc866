// SPDX-License-Identifier: GPL-3.0-or-later
// Where a micropolygon is while the samples of ranks look: included once a SIMD target inside its
// namespace, after path_extents.inl and tile_bounds.inl.

/// Where a micropolygon is while the samples of a rank look, a vector of ranks.
struct RankPaths {
    alignas(64) int x0[kPacket], x1[kPacket], y0[kPacket], y1[kPacket];  ///< blocks, inclusive
    /// On an axis: it stays within `reach` of place + speed t + shear u for a sample's t and u;
    /// where samples have a focus each, of place + speed t + (shear + depth / focus) u.
    struct Axis {
        alignas(64) float place[kPacket], speed[kPacket], reach[kPacket];
    } x, y;
    alignas(64) float shear[kPacket], depth[kPacket];
};

/// Where micropolygons go while they are over a tile, a vector of them: a rank's samples see a part
/// of that path.
struct TilePaths {
    struct Axis {
        alignas(64) float place[kPacket], speed[kPacket], reach[kPacket];  ///< StraightPath
    } x, y;
    /// LensExtents, as far as the lens has them.
    alignas(64) float shear_lo[kPacket], shear_hi[kPacket], depth_lo[kPacket], depth_hi[kPacket],
        reciprocal_lo[kPacket], reciprocal_hi[kPacket];
    alignas(64) float z_lo[kPacket];
    std::uint32_t straight = 0;  ///< bit i: micropolygon i stays that near to one line
};

/// When something is over a tile: a part of a segment of motion, or several segments.
template <bool kMoving>
struct SegmentPart {
    V ends[2];       ///< in parts of the segment
    V time0, time1;  ///< of the shutter

    HWY_INLINE SegmentPart(const SimdGrid& grid, Segments segments, const BlockRanges& times) {
        const V zero = set(0.0f), one = set(1.0f);
        const V knots = set(static_cast<float>(std::max(1, grid.segments)));
        const V start = set(static_cast<float>(segments.first));
        ends[0] = ends[1] = zero;
        if constexpr (kMoving) {
            const auto end = [&](const float* time) HWY_ATTR {
                return hn::Min(hn::Max(hn::LoadU(kTag, time) * knots - start, zero), one);
            };
            ends[0] = end(times.t0);
            ends[1] = hn::Max(ends[0], end(times.t1));
        }
        if (segments.count > 1) {
            ends[0] = zero;
            ends[1] = set(static_cast<float>(segments.count));
        }
        time0 = (ends[0] + start) / knots;
        time1 = (ends[1] + start) / knots;
    }
};

/// All of several segments, or as much as the grid exists for.
HWY_INLINE void store_times(const SimdGrid& grid, Segments segments, BlockRanges& out) {
    const V knots = set(static_cast<float>(grid.segments));
    const V begin = set(static_cast<float>(segments.first));
    const V end = set(static_cast<float>(segments.first + segments.count));
    hn::StoreU(hn::Max(begin / knots, set(grid.lifespan.open)), kTag, out.t0);
    hn::StoreU(hn::Min(end / knots, set(grid.lifespan.close)), kTag, out.t1);
}

/// A grid over the ranks of a tile.
class RankPathFinder {
  public:
    /// Squares of the hierarchical depth in a row that are looked at: what a micropolygon needs,
    /// and all that a tile has.
    static constexpr int kFewSquares = 2, kAllSquares = 4;

    RankPathFinder(const SimdGrid& grid, const SimdTile& tile) : m_grid(grid), m_tile(tile) {}

    /// The paths of the micropolygons from `vertex` on between the times at which they are over the
    /// tile (TileBounds::find_times).
    template <bool kMoving, Lens kLens>
    HWY_INLINE void find_paths(int segment, int vertex, const BlockRanges& times,
                               TilePaths& out) const {
        const SegmentPart<kMoving> part(m_grid, {segment, 1}, times);
        const std::size_t knot = static_cast<std::size_t>(segment) * m_grid.vertices;
        PathExtents<kMoving, kLens> extents(hn::FirstN(kTag, kPacket));
        for (const int corner : {vertex, vertex + m_grid.right, vertex + m_grid.up,
                                 vertex + m_grid.up + m_grid.right}) {
            const std::size_t a = knot + static_cast<std::size_t>(corner);
            const Corner<V> begin = load_corner(m_grid, a);
            Corner<V> delta = begin;
            if constexpr (kMoving)
                delta = from_to(begin,
                                load_corner(m_grid, a + static_cast<std::size_t>(m_grid.vertices)));
            extents.add(m_grid, begin, delta, part.ends);
        }
        store_paths(extents, part, out);
    }

    /// Of what has these extents, a vector of things.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void store_paths(const PathExtents<kMoving, kLens>& extents,
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
        hn::StoreU(extents.z_lo, kTag, out.z_lo);
        out.straight = bits_of(straight);
    }

    /// The part of a straight path, `lane` of find_paths(), that the samples of each of these ranks
    /// can see, and which of the ranks have any that do not see something nearer.
    template <bool kMoving, Lens kLens, int kSquares = kFewSquares>
    HWY_INLINE M follow(const TilePaths& paths, int lane, Segments segments, int first, bool cull,
                        RankPaths& out) const {
        const RankBounds& bounds = *m_tile.bounds;
        const V t_lo = rank(bounds.t_lo, first), t_hi = rank(bounds.t_hi, first);
        M present = hn::Le(t_lo, t_hi);
        if constexpr (kMoving) present = hn::And(present, in_segments(t_lo, t_hi, segments));
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
                              const std::vector<float>& lens_hi, RankPaths::Axis& to, V& lo,
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
            if constexpr (kLens != Lens::None)
                add_lens(shear, rank(lens_lo, first), rank(lens_hi, first), reach, lo, hi);
            hn::StoreU(place, kTag, to.place);
            hn::StoreU(reach, kTag, to.reach);
        };
        axis(paths.x, bounds.u_lo, bounds.u_hi, out.x, box.x_lo, box.x_hi);
        axis(paths.y, bounds.v_lo, bounds.v_hi, out.y, box.y_lo, box.y_hi);
        store_shear<kLens>(shear, present, out);
        return find_blocks<kSquares>(present, box, set(paths.z_lo[lane]), first, cull, out);
    }

    /// The same by where the micropolygon is during each of the ranks: for paths that are bent.
    template <bool kMoving, Lens kLens>
    HWY_INLINE M find(const Shape& shape, int segment, int first, bool cull, RankPaths& out) const {
        const RankBounds& bounds = *m_tile.bounds;
        const V zero = set(0.0f), one = set(1.0f);
        const V t_lo = rank(bounds.t_lo, first), t_hi = rank(bounds.t_hi, first);
        M present = hn::Le(t_lo, t_hi);
        const V knots = set(static_cast<float>(std::max(1, m_grid.segments)));
        const V start = set(static_cast<float>(segment));
        V ends[2] = {zero, zero};
        if constexpr (kMoving) {
            present = hn::And(present, in_segments(t_lo, t_hi, {segment, 1}));
            ends[0] = hn::Max(t_lo * knots - start, zero);
            ends[1] = hn::Min(t_hi * knots - start, one);
        }
        PathExtents<kMoving, kLens> extents(present);
        for (int k = 0; k < 4; ++k)
            extents.add(m_grid, shape.begin_of(k), shape.delta_of(k), ends);
        const V time0 = (ends[0] + start) / knots, time1 = (ends[1] + start) / knots;
        const Shear shear = shear_of<kLens>(extents.lens, first);
        M sane = extents.sane;
        Box box;
        const auto axis = [&](const Extent& at, V bend, const std::vector<float>& lens_lo,
                              const std::vector<float>& lens_hi, RankPaths::Axis& to, V& lo,
                              V& hi) HWY_ATTR {
            const StraightPath path = extents.straight(at, bend, time0, time1);
            V reach = path.reach + extents.margin;
            lo = at.lo[0];
            hi = at.hi[0];
            if constexpr (kMoving) {
                lo = hn::Min(lo, at.lo[1]);
                hi = hn::Max(hi, at.hi[1]);
                hn::StoreU(hn::IfThenElseZero(sane, path.speed), kTag, to.speed);
            }
            lo = lo - extents.margin;
            hi = hi + extents.margin;
            if constexpr (kLens != Lens::None)
                add_lens(shear, rank(lens_lo, first), rank(lens_hi, first), reach, lo, hi);
            sane = hn::And(sane, hn::Lt(reach + hn::Abs(lo) + hn::Abs(hi), set(1e15f)));
            hn::StoreU(path.place, kTag, to.place);
            hn::StoreU(reach, kTag, to.reach);
        };
        axis(extents.x, extents.bend_x, bounds.u_lo, bounds.u_hi, out.x, box.x_lo, box.x_hi);
        axis(extents.y, extents.bend_y, bounds.v_lo, bounds.v_hi, out.y, box.y_lo, box.y_hi);
        store_shear<kLens>(shear, sane, out);
        if (HWY_UNLIKELY(!hn::AllTrue(kTag, hn::Or(sane, hn::Not(present))))) {
            // At or behind the eye plane: anywhere.
            const V never = set(INFINITY);
            for (RankPaths::Axis* to : {&out.x, &out.y}) {
                hn::StoreU(hn::IfThenElseZero(sane, hn::LoadU(kTag, to->place)), kTag, to->place);
                hn::StoreU(hn::IfThenElse(sane, hn::LoadU(kTag, to->reach), never), kTag,
                           to->reach);
            }
            box.x_lo = hn::IfThenElse(sane, box.x_lo, hn::Neg(never));
            box.y_lo = hn::IfThenElse(sane, box.y_lo, hn::Neg(never));
            box.x_hi = hn::IfThenElse(sane, box.x_hi, never);
            box.y_hi = hn::IfThenElse(sane, box.y_hi, never);
        }
        return find_blocks<kFewSquares>(present, box, extents.z_lo, first, cull, out);
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
    /// Paths that bend more are looked at rank by rank, pixels.
    static constexpr float kMostBend = 0.125f;

    struct Box {
        V x_lo, x_hi, y_lo, y_hi;
    };

    static HWY_INLINE V rank(const std::vector<float>& values, int first) {
        return hn::LoadU(kTag, values.data() + first);
    }
    /// Which of these intervals of time touch the segments.
    HWY_INLINE M in_segments(V t_lo, V t_hi, Segments segments) const {
        const V knots = set(static_cast<float>(m_grid.segments));
        const V start = set(static_cast<float>(segments.first));
        return hn::And(hn::Ge(t_hi * knots - start, set(0.0f)),
                       hn::Le(t_lo * knots - start, set(static_cast<float>(segments.count))));
    }

    /// At the times of ranks.
    template <Lens kLens>
    HWY_INLINE Shear shear_of(const LensExtents& lens, int first) const {
        V far = set(0.0f), near = far;
        if constexpr (kLens == Lens::Refocused) {
            far = rank(m_tile.bounds->focus_lo, first);
            near = rank(m_tile.bounds->focus_hi, first);
        }
        return shear_of<kLens>(lens, far, near);
    }

    /// Shears what is bounded by lens coordinates from u_lo to u_hi.
    static HWY_INLINE void add_lens(const Shear& shear, V u_lo, V u_hi, V& reach, V& lo, V& hi) {
        reach = reach + hn::Max(hn::Abs(u_lo), hn::Abs(u_hi)) * shear.rest;
        const V a = shear.lo * u_lo, b = shear.lo * u_hi;
        const V c = shear.hi * u_lo, d = shear.hi * u_hi;
        lo = lo + hn::Min(hn::Min(a, b), hn::Min(c, d));
        hi = hi + hn::Max(hn::Max(a, b), hn::Max(c, d));
    }

    /// 0 where not `known`.
    template <Lens kLens>
    static HWY_INLINE void store_shear(const Shear& shear, M known, RankPaths& out) {
        if constexpr (kLens != Lens::None)
            hn::StoreU(hn::IfThenElseZero(known, shear.middle), kTag, out.shear);
        if constexpr (kLens == Lens::Refocused)
            hn::StoreU(hn::IfThenElseZero(known, shear.depth), kTag, out.depth);
    }

    template <int kSquares>
    HWY_INLINE M find_blocks(M present, const Box& box, V z_lo, int first, bool cull,
                             RankPaths& out) const {
        present =
            hn::And(present, store_blocks(m_tile, box.x_lo, box.x_hi, box.y_lo, box.y_hi, out));
        if (!cull || hn::AllFalse(kTag, present)) return present;
        // The key of a sample may round a few ulp past the nearest corner's.
        V nearest = hn::Neg(z_lo);
        if (m_grid.range.perspective)
            nearest = hn::IfThenElse(hn::Gt(z_lo, set(0.0f)), set(1.0f) / z_lo, set(INFINITY));
        return hn::AndNot(hidden<kSquares>(nearest + hn::Abs(nearest) * set(0x1p-18f), first, out),
                          present);
    }

    /// Whether all samples of the blocks see something nearer, by the hierarchical depth of the
    /// ranks; only where the blocks lie in at most kSquares by kSquares of its squares.
    template <int kSquares>
    HWY_INLINE M hidden(V nearest, int first, const RankPaths& blocks) const {
        const auto square = [&](const int* block) HWY_ATTR {
            return hn::ShiftRightSame(hn::LoadU(kIntTag, block), m_tile.square_shift);
        };
        const auto x0 = square(blocks.x0), x1 = square(blocks.x1);
        const auto y0 = square(blocks.y0), y1 = square(blocks.y1);
        const auto most = hn::Set(kIntTag, kSquares);
        const auto few = hn::And(hn::Lt(x1 - x0, most), hn::Lt(y1 - y0, most));
        const auto wide = hn::Set(kIntTag, m_tile.squares_wide);
        const auto ranks = hn::Set(kIntTag, m_tile.ranks);
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
                    hn::Min(least, hn::GatherIndex(kTag, m_tile.farthest_of_ranks + first,
                                                   (y * wide + x) * ranks + hn::Iota(kIntTag, 0)));
            }
        return hn::And(hn::RebindMask(kTag, few), hn::Lt(nearest, least));
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
};
