// SPDX-License-Identifier: GPL-3.0-or-later
// Where a micropolygon is while the samples of strata look: included once a SIMD target inside its
// namespace, after swept_bounds.inl and tile_bounds.inl.

/// StraightPath, a vector of them.
struct StraightPaths {
    alignas(64) float place[kPacket], speed[kPacket], reach[kPacket];

    HWY_INLINE void store(const StraightPath& path) {
        hn::Store(path.place, kTag, place);
        hn::Store(path.speed, kTag, speed);
        hn::Store(path.reach, kTag, reach);
    }
    /// One of them in all lanes.
    HWY_INLINE StraightPath of(int lane) const {
        return {set(place[lane]), set(speed[lane]), set(reach[lane])};
    }
};

/// Where a micropolygon is while the samples of a stratum look, a vector of strata.
struct StratumPaths {
    alignas(64) int x0[kPacket], x1[kPacket], y0[kPacket], y1[kPacket];  ///< blocks, inclusive
    /// On an axis it stays within `reach` of place + speed t + shear u for a sample's t and u;
    /// where samples have a focus each, of place + speed t + (shear + depth / focus) u.
    StraightPaths x, y;
    alignas(64) float shear[kPacket], depth[kPacket];
};

/// Where micropolygons go while they are over a tile, a vector of them: a stratum's samples see a
/// part of that path.
struct TilePaths {
    StraightPaths x, y;
    /// LensExtents, through a lens.
    alignas(64) float depth_lo[kPacket], depth_hi[kPacket], reciprocal_lo[kPacket],
        reciprocal_hi[kPacket];
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

    /// The corners of the micropolygons whose corner 0 is at `vertex`, all of which are over the
    /// tile when `part` says; calls added() after each.
    template <bool kMoving, Lens kLens, class Added>
    HWY_INLINE void add_corners(int segment, int vertex, const SegmentPart<kMoving>& part,
                                SweptBounds<kMoving, kLens>& to, Added added) const {
        for_each_corner(m_grid, segment, vertex, [&](std::size_t i) HWY_ATTR {
            const Corner<V> begin = load_corner(m_grid, i);
            Corner<V> delta = begin;
            if constexpr (kMoving)
                delta = from_to(begin,
                                load_corner(m_grid, i + static_cast<std::size_t>(m_grid.vertices)));
            to.add(m_grid, begin, delta, part.ends);
            added();
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
        add_corners(segment, vertex, part, extents, [] {});
        store_paths(extents, part, out);
        if constexpr (kMoving) {
            hn::StoreU(first, kTag, out.t0);
            hn::StoreU(last, kTag, out.t1);
            return present;
        } else {
            return hn::And(present, find_touching(extents, out));
        }
    }

    /// Which of those that do not move touch the tile, and which blocks.
    template <Lens kLens, class Out>
    HWY_INLINE M find_touching(const SweptBounds<false, kLens>& extents, Out& out) const {
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
        const auto axis = [&](const Extent(&at)[2], V bend, StraightPaths& to) HWY_ATTR {
            to.store(extents.straight(at, bend, part.time0, part.time1, kMostBend, straight));
        };
        axis(extents.x, extents.bend_x, out.x);
        axis(extents.y, extents.bend_y, out.y);
        if constexpr (kLens != Lens::None) {
            hn::Store(extents.lens.depth.lo, kTag, out.depth_lo);
            hn::Store(extents.lens.depth.hi, kTag, out.depth_hi);
            hn::Store(extents.lens.reciprocal.lo, kTag, out.reciprocal_lo);
            hn::Store(extents.lens.reciprocal.hi, kTag, out.reciprocal_hi);
        }
        hn::StoreU(extents.nearest_key(m_grid.range.perspective), kTag, out.nearest);
        out.straight = bits_of(straight);
    }

    /// The part of a straight path, `lane` of find_paths(), that the samples of each of these
    /// strata can see, and which of the strata have any that do not see something nearer.
    template <bool kMoving, Lens kLens, int kSquares = kFewSquares>
    HWY_INLINE M follow(const TilePaths& paths, int lane, int segment, int first, bool cull,
                        StratumPaths& out) const {
        LensExtents lens;
        if constexpr (kLens != Lens::None) {
            lens.depth.lo = set(paths.depth_lo[lane]);
            lens.depth.hi = set(paths.depth_hi[lane]);
            lens.reciprocal.lo = set(paths.reciprocal_lo[lane]);
            lens.reciprocal.hi = set(paths.reciprocal_hi[lane]);
        }
        const M present = looking<kMoving>(segment, first);
        const V times[2] = {stratum(m_tile.bounds->t_lo, first),
                            stratum(m_tile.bounds->t_hi, first)};
        const V nearest = set(paths.nearest[lane]);
        return look<kMoving, kLens, kSquares>(paths.x.of(lane), paths.y.of(lane), times, lens,
                                              nearest, present, first, cull, out);
    }

    /// The same by where the micropolygon is during each of the strata: for paths that are bent.
    template <bool kMoving, Lens kLens>
    HWY_INLINE M find(const Shape& shape, int segment, int first, bool cull,
                      StratumPaths& out) const {
        const StratumBounds& bounds = *m_tile.bounds;
        const SegmentPart<kMoving> during(m_grid, segment, stratum(bounds.t_lo, first),
                                          stratum(bounds.t_hi, first));
        const M present = looking<kMoving>(segment, first);
        SweptBounds<kMoving, kLens> extents(present);
        for (int k = 0; k < 4; ++k)
            extents.add(m_grid, shape.begin_of(k), shape.delta_of(k), during.ends);
        M sane = extents.sane;
        const auto axis = [&](const Extent(&at)[2], V bend) HWY_ATTR {
            return extents.straight(at, bend, during.time0, during.time1, INFINITY, sane);
        };
        StraightPath x = axis(extents.x, extents.bend_x), y = axis(extents.y, extents.bend_y);
        // At or behind the eye plane: anywhere.
        const auto known = [&](V& value, float otherwise)
                               HWY_ATTR { value = hn::IfThenElse(sane, value, set(otherwise)); };
        for (StraightPath* path : {&x, &y}) {
            known(path->place, 0.0f);
            known(path->speed, 0.0f);
            known(path->reach, INFINITY);
        }
        if constexpr (kLens != Lens::None)
            for (Extent* extent : {&extents.lens.depth, &extents.lens.reciprocal}) {
                known(extent->lo, 0.0f);
                known(extent->hi, 0.0f);
            }
        const V nearest = extents.nearest_key(m_grid.range.perspective);
        // Not beyond the segment, where it bends on.
        const V times[2] = {during.time0, during.time1};
        return look<kMoving, kLens, kFewSquares>(x, y, times, extents.lens, nearest, present, first,
                                                 cull, out);
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

    /// What a lens coordinate of 1 shifts by: from lo to hi, and within `rest` of `middle`; where
    /// samples have a focus each, 1 / focus from far to near, of middle + depth / focus.
    struct Shear {
        V lo, hi, middle, depth, rest;
    };
    template <Lens kLens>
    static HWY_INLINE Shear shear_of(const LensExtents& lens, V far, V near) {
        const V zero = set(0.0f), half = set(0.5f), rounding = set(0x1p-20f);
        if constexpr (kLens == Lens::None) return {zero, zero, zero, zero, zero};
        const V d0 = lens.depth.lo, d1 = lens.depth.hi;
        const V r0 = lens.reciprocal.lo, r1 = lens.reciprocal.hi;
        Shear shear;
        shear.lo = hn::Min(hn::Min(d0 * far, d0 * near), hn::Min(d1 * far, d1 * near)) - r1;
        shear.hi = hn::Max(hn::Max(d0 * far, d0 * near), hn::Max(d1 * far, d1 * near)) - r0;
        shear.middle = hn::Neg((r0 + r1) * half);
        shear.depth = (d0 + d1) * half;
        shear.rest = (r1 - r0) * half + near * (d1 - d0) * half +
                     (hn::Abs(shear.middle) + near * hn::Abs(shear.depth)) * rounding;
        if constexpr (kLens == Lens::Still) shear.middle = shear.middle + shear.depth * near;
        return shear;
    }

  private:
    /// Paths that bend more are looked at stratum by stratum, pixels.
    static constexpr float kMostBend = 0.125f;

    static HWY_INLINE V stratum(const std::vector<float>& values, int first) {
        return hn::LoadU(kTag, values.data() + first);
    }
    /// Which of these strata have samples that look during the segment.
    template <bool kMoving>
    HWY_INLINE M looking(int segment, int first) const {
        const V t_lo = stratum(m_tile.bounds->t_lo, first);
        const V t_hi = stratum(m_tile.bounds->t_hi, first);
        const M present = hn::Le(t_lo, t_hi);
        if constexpr (!kMoving) return present;
        const V knots = set(static_cast<float>(m_grid.segments));
        const V start = set(static_cast<float>(segment));
        return hn::And(present, hn::And(hn::Ge(t_hi * knots - start, set(0.0f)),
                                        hn::Le(t_lo * knots - start, set(1.0f))));
    }

    /// What is on these paths while the samples of the strata look that are `present`, from
    /// times[0] to times[1], and which of those have any that do not see something nearer.
    template <bool kMoving, Lens kLens, int kSquares>
    HWY_INLINE M look(const StraightPath& x, const StraightPath& y, const V (&times)[2],
                      const LensExtents& lens, V nearest, M present, int first, bool cull,
                      StratumPaths& out) const {
        const StratumBounds& bounds = *m_tile.bounds;
        Shear shear;
        if constexpr (kLens == Lens::Still)
            shear = shear_of<kLens>(lens, set(m_grid.inverse_focus), set(m_grid.inverse_focus));
        if constexpr (kLens == Lens::Refocused)
            shear = shear_of<kLens>(lens, stratum(bounds.focus_lo, first),
                                    stratum(bounds.focus_hi, first));
        const auto axis = [&](StraightPath path, const std::vector<float>& lens_lo,
                              const std::vector<float>& lens_hi, StraightPaths& to, V& lo,
                              V& hi) HWY_ATTR {
            V a = path.place, b = a;
            if constexpr (kMoving) {
                a = path.at(times[0]);
                b = path.at(times[1]);
            }
            lo = hn::Min(a, b) - path.reach;
            hi = hn::Max(a, b) + path.reach;
            if constexpr (kLens != Lens::None) {
                const V u_lo = stratum(lens_lo, first), u_hi = stratum(lens_hi, first);
                add_lens(shear, u_lo, u_hi, lo, hi);
                path.reach = path.reach + lens_rest(shear, u_lo, u_hi);
            }
            to.store(path);
        };
        Box box;
        axis(x, bounds.u_lo, bounds.u_hi, out.x, box.x_lo, box.x_hi);
        axis(y, bounds.v_lo, bounds.v_hi, out.y, box.y_lo, box.y_hi);
        if constexpr (kLens != Lens::None) hn::Store(shear.middle, kTag, out.shear);
        if constexpr (kLens == Lens::Refocused) hn::Store(shear.depth, kTag, out.depth);
        present = hn::And(present, store_blocks(m_tile, box, out));
        if (!cull || hn::AllFalse(kTag, present)) return present;
        return hn::AndNot(hidden<kSquares>(nearest, first, out), present);
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
