// SPDX-License-Identifier: GPL-3.0-or-later
// *Swept bounds*: boxes of what the corners of micropolygons sweep over intervals of time. Included
// once a SIMD target inside its namespace, after tile_bounds.inl.  Lanes are intervals of one
// micropolygon, or micropolygons with an interval each.

/// Of an interval of time: what is still is the same at both.
template <bool kMoving>
constexpr int kEnds = kMoving ? 2 : 1;

/// Least and most.
struct Extent {
    V lo, hi;

    HWY_INLINE Extent() : lo(set(INFINITY)), hi(set(-INFINITY)) {}
    HWY_INLINE void add(V value) {
        lo = hn::Min(lo, value);
        hi = hn::Max(hi, value);
    }
    /// Also what another has in the lanes of the mask.
    HWY_INLINE void merge(const Extent& other, M mask) {
        lo = hn::Min(lo, hn::IfThenElse(mask, other.lo, lo));
        hi = hn::Max(hi, hn::IfThenElse(mask, other.hi, hi));
    }
    /// All lanes are of one thing.
    HWY_INLINE void reduce() {
        lo = hn::MinOfLanes(kTag, lo);
        hi = hn::MaxOfLanes(kTag, hi);
    }
};

/// Along one axis something stays within `reach` of place + speed t.
struct StraightPath {
    V place, speed, reach;

    HWY_INLINE V at(V time) const { return place + speed * time; }
};

/// At both ends together: a lens point u shifts by u (depth / focus - reciprocal), of which
/// perspective leaves depth = 1.
struct LensExtents {
    Extent depth, reciprocal;
    HWY_INLINE LensExtents() {}  // the implicit one is of no target
};

/// For a fixed lens point a corner moves monotonically between the ends of its interval of time,
/// whatever the perspective, and for a fixed time linearly in the lens point (compare Laine et al.
/// 2011): its extremes are at the ends.
template <bool kMoving, Lens kLens>
struct SweptBounds {
    Extent x[2], y[2];  ///< at the begin and the end of the intervals
    LensExtents lens;
    V z_lo;
    V margin;                ///< more than rounding and the exact test need
    V bend_x, bend_y;        ///< how far paths leave their chords
    M sane;                  ///< before the eye plane
    V last_x[2], last_y[2];  ///< where the corner that was added last is at the ends

    HWY_INLINE explicit SweptBounds(M present) : sane(present) {
        z_lo = set(INFINITY);
        margin = bend_x = bend_y = set(0.0f);
    }

    /// The corners at the two `ends` of the intervals, in parts of the segment.
    HWY_INLINE void add(const SimdGrid& grid, const Corner<V>& c, const Corner<V>& d,
                        const V ends[2]) {
        const V rounding = rounding_of(grid, c, d);
        Step was;
        for (int e = 0; e < kEnds<kMoving>; ++e) {
            const Step now = step(kMoving ? at_time(c, d, ends[e]) : c, rounding);
            if (e == 1) {
                bend_x = hn::Max(bend_x, bend(was.x, now.x, was, now));
                bend_y = hn::Max(bend_y, bend(was.y, now.y, was, now));
            }
            add_end(now, e);
            was = now;
        }
    }

    /// Also what others have in the lanes of the mask.
    HWY_INLINE void merge(const SweptBounds& other, M mask) {
        for (int e = 0; e < kEnds<kMoving>; ++e) {
            x[e].merge(other.x[e], mask);
            y[e].merge(other.y[e], mask);
        }
        lens.depth.merge(other.lens.depth, mask);
        lens.reciprocal.merge(other.lens.reciprocal, mask);
        z_lo = hn::Min(z_lo, hn::IfThenElse(mask, other.z_lo, z_lo));
        margin = hn::Max(margin, hn::IfThenElse(mask, other.margin, margin));
        bend_x = hn::Max(bend_x, hn::IfThenElse(mask, other.bend_x, bend_x));
        bend_y = hn::Max(bend_y, hn::IfThenElse(mask, other.bend_y, bend_y));
        sane = hn::And(sane, hn::Or(other.sane, hn::Not(mask)));
    }

    /// All lanes are of one thing.
    HWY_INLINE void reduce() {
        for (int e = 0; e < kEnds<kMoving>; ++e) {
            x[e].reduce();
            y[e].reduce();
        }
        lens.depth.reduce();
        lens.reciprocal.reduce();
        z_lo = hn::MinOfLanes(kTag, z_lo);
        margin = hn::MaxOfLanes(kTag, margin);
        bend_x = hn::MaxOfLanes(kTag, bend_x);
        bend_y = hn::MaxOfLanes(kTag, bend_y);
        sane = hn::AllTrue(kTag, sane) ? sane : hn::MaskFromVec(set(0.0f));
    }

    /// No sample sees a nearer key: it may round a few ulp past the nearest corner's.
    HWY_INLINE V nearest_key(bool perspective) const {
        V key = hn::Neg(z_lo);
        if (perspective)
            key = hn::IfThenElse(hn::Gt(z_lo, set(0.0f)), set(1.0f) / z_lo, set(INFINITY));
        return key + hn::Abs(key) * set(0x1p-18f);
    }

    /// Where it is, of what is still, without lens.
    HWY_INLINE Box box() const {
        static_assert(!kMoving);
        return {x[0].lo - margin, x[0].hi + margin, y[0].lo - margin, y[0].hi + margin};
    }

    /// Of `at`, x or y, between the times of the ends.  Without lens; takes from `fit` those that
    /// bend by more than `most_bend` or are too large for a number.
    HWY_INLINE StraightPath straight(const Extent (&at)[2], V bend, V time0, V time1,
                                     float most_bend, M& fit) const {
        const V half = set(0.5f), begin = (at[0].lo + at[0].hi) * half;
        StraightPath path{begin, set(0.0f), (at[0].hi - at[0].lo) * half};
        if constexpr (kMoving) {
            const V end = (at[1].lo + at[1].hi) * half, span = time1 - time0;
            const V reach = hn::Max(path.reach, (at[1].hi - at[1].lo) * half) + bend;
            const M long_enough = hn::Gt(span, set(1e-6f));
            path.speed = hn::IfThenElseZero(long_enough, (end - begin) / span);
            path.reach = hn::IfThenElse(long_enough, reach, reach + hn::Abs(end - begin));
            path.place = begin - path.speed * time0;
            path.reach = path.reach + (hn::Abs(path.place) + hn::Abs(path.speed)) * set(0x1p-20f);
        }
        path.reach = path.reach + margin;
        fit = hn::And(fit, hn::And(hn::Le(bend, set(most_bend)),
                                   hn::Lt(hn::Abs(path.place) + path.reach, set(1e15f))));
        return path;
    }

  private:
    /// Where a corner is, on the raster.
    struct Step {
        V x, y, w, inverse, rounding;
        HWY_INLINE Step() {}  // the implicit one is of no target
    };

    /// Adds all but where it is.
    HWY_INLINE Step step(const Corner<V>& at, V rounding) {
        const V one = set(1.0f);
        Step now;
        now.w = at.w;
        now.rounding = rounding;
        now.inverse = one / at.w;
        now.x = at.x * now.inverse;
        now.y = at.y * now.inverse;
        if constexpr (kLens != Lens::None) {
            lens.depth.add(at.z * now.inverse);
            lens.reciprocal.add(now.inverse);
        }
        z_lo = hn::Min(z_lo, at.z);
        margin = hn::Max(margin, rounding * now.inverse);
        sane = hn::And(sane, hn::Gt(at.w, set(1e-15f)));
        return now;
    }

    HWY_INLINE void add_end(const Step& at, int end) {
        last_x[end] = at.x;
        last_y[end] = at.y;
        x[end].add(at.x);
        y[end].add(at.y);
    }

    /// A path in perspective leaves its chord, from p to q, by at most |chord| |dw| / (4 w).
    static HWY_INLINE V bend(V p, V q, const Step& a, const Step& b) {
        const V curved = hn::Abs(b.w - a.w) * hn::Max(a.inverse, b.inverse) * set(0.25f);
        return hn::Abs(q - p) * curved;
    }

    /// More than a corner's offset from a sample of the tile can round by, times w.
    static HWY_INLINE V rounding_of(const SimdGrid& grid, const Corner<V>& c, const Corner<V>& d) {
        const auto largest = [](V begin, V delta) HWY_ATTR {
            if constexpr (!kMoving) return hn::Abs(begin);
            return hn::Max(hn::Abs(begin), hn::Abs(begin + delta));
        };
        const V place = hn::Max(largest(c.x, d.x), largest(c.y, d.y));
        V rounding = largest(c.w, d.w) * set(1.0f / 256) + place * set(0x1p-20f);
        if constexpr (kLens != Lens::None) {
            const V depth = largest(c.z, d.z) * set(grid.inverse_focus) + set(1.0f);
            rounding = rounding + set(std::max(grid.lens_x, grid.lens_y) * 0x1p-20f) * depth;
        }
        return rounding;
    }
};
