// SPDX-License-Identifier: GPL-3.0-or-later
// Where the corners of micropolygons are over intervals of time: included once a SIMD target inside
// its namespace, after packet_vectors.inl.  Lanes are intervals of one micropolygon, or
// micropolygons with an interval each.

/// Least and most at the begin and the end of the intervals.
struct Extent {
    V lo[2], hi[2];

    HWY_INLINE Extent() {
        lo[0] = lo[1] = set(INFINITY);
        hi[0] = hi[1] = set(-INFINITY);
    }
    HWY_INLINE void add(V value, int end) {
        lo[end] = hn::Min(lo[end], value);
        hi[end] = hn::Max(hi[end], value);
    }
    /// Also what another has in the lanes of the mask.
    HWY_INLINE void merge(const Extent& other, M mask) {
        for (int end = 0; end < 2; ++end) {
            lo[end] = hn::Min(lo[end], hn::IfThenElse(mask, other.lo[end], lo[end]));
            hi[end] = hn::Max(hi[end], hn::IfThenElse(mask, other.hi[end], hi[end]));
        }
    }
    /// All lanes are of one thing.
    HWY_INLINE void reduce() {
        for (V& value : lo) value = hn::MinOfLanes(kTag, value);
        for (V& value : hi) value = hn::MaxOfLanes(kTag, value);
    }
};

/// Along one axis something stays within `reach` of place + speed t.
struct StraightPath {
    V place, speed, reach;
};

/// Of (z / focus - 1) / w at both ends together: a still lens has `shear`; where samples have a
/// focus each it is `depth` / focus - `reciprocal`, of which perspective leaves depth = 1.
struct LensExtents {
    Extent shear, depth, reciprocal;
    HWY_INLINE LensExtents() {}  // the implicit one is of no target
};

/// For a fixed lens point a corner moves monotonically between the ends of its interval of time,
/// whatever the perspective, and for a fixed time linearly in the lens point (compare Laine et al.
/// 2011): its extremes are at the ends.
template <bool kMoving, Lens kLens>
struct PathExtents {
    Extent x, y;
    LensExtents lens;
    V z_lo;
    V margin;                ///< more than rounding and the exact test need
    V bend_x, bend_y;        ///< how far paths leave their chords
    M sane;                  ///< before the eye plane
    V last_x[2], last_y[2];  ///< where the corner that was added last is at the ends

    HWY_INLINE explicit PathExtents(M present) : sane(present) {
        z_lo = set(INFINITY);
        margin = bend_x = bend_y = set(0.0f);
    }

    /// The corners at the two `ends` of the intervals, in parts of the segment.
    HWY_INLINE void add(const SimdGrid& grid, const Corner<V>& c, const Corner<V>& d,
                        const V ends[2]) {
        const V zero = set(0.0f), one = set(1.0f);
        const V rounding = rounding_of(grid, c, d);
        V was_x = zero, was_y = zero, was_w = zero, most = zero;
        for (int e = 0; e < (kMoving ? 2 : 1); ++e) {
            const Corner<V> at = kMoving ? at_time(c, d, ends[e]) : c;
            const V inverse = one / at.w;
            const V at_x = at.x * inverse, at_y = at.y * inverse;
            last_x[e] = at_x;
            last_y[e] = at_y;
            x.add(at_x, e);
            y.add(at_y, e);
            if constexpr (kLens == Lens::Still)
                lens.shear.add((at.z * set(grid.inverse_focus) - one) * inverse, 0);
            if constexpr (kLens == Lens::Refocused) {
                lens.depth.add(at.z * inverse, 0);
                lens.reciprocal.add(inverse, 0);
            }
            z_lo = hn::Min(z_lo, at.z);
            margin = hn::Max(margin, rounding * inverse);
            sane = hn::And(sane, hn::Gt(at.w, set(1e-15f)));
            most = hn::Max(most, inverse);
            if (e == 1) {
                // A path in perspective leaves its chord by at most |chord| |dw| / (4 w).
                const V curved = hn::Abs(at.w - was_w) * most * set(0.25f);
                bend_x = hn::Max(bend_x, hn::Abs(at_x - was_x) * curved);
                bend_y = hn::Max(bend_y, hn::Abs(at_y - was_y) * curved);
            }
            was_x = at_x;
            was_y = at_y;
            was_w = at.w;
        }
    }

    /// Also what others have in the lanes of the mask.
    HWY_INLINE void merge(const PathExtents& other, M mask) {
        x.merge(other.x, mask);
        y.merge(other.y, mask);
        lens.shear.merge(other.lens.shear, mask);
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
        x.reduce();
        y.reduce();
        lens.shear.reduce();
        lens.depth.reduce();
        lens.reciprocal.reduce();
        z_lo = hn::MinOfLanes(kTag, z_lo);
        margin = hn::MaxOfLanes(kTag, margin);
        bend_x = hn::MaxOfLanes(kTag, bend_x);
        bend_y = hn::MaxOfLanes(kTag, bend_y);
        sane = hn::AllTrue(kTag, sane) ? sane : hn::MaskFromVec(set(0.0f));
    }

    /// `time0`, `time1`: the ends, times of the shutter.  Without lens and margin.
    HWY_INLINE static StraightPath straight(const Extent& at, V bend, V time0, V time1) {
        const V half = set(0.5f), begin = (at.lo[0] + at.hi[0]) * half;
        StraightPath path{begin, set(0.0f), (at.hi[0] - at.lo[0]) * half};
        if constexpr (kMoving) {
            const V end = (at.lo[1] + at.hi[1]) * half, span = time1 - time0;
            const V reach = hn::Max(path.reach, (at.hi[1] - at.lo[1]) * half) + bend;
            const M long_enough = hn::Gt(span, set(1e-6f));
            path.speed = hn::IfThenElseZero(long_enough, (end - begin) / span);
            path.reach = hn::IfThenElse(long_enough, reach, reach + hn::Abs(end - begin));
            path.place = begin - path.speed * time0;
            path.reach = path.reach + (hn::Abs(path.place) + hn::Abs(path.speed)) * set(0x1p-20f);
        }
        return path;
    }

  private:
    /// More than a corner's offset from a sample of the tile can round by, times w.
    static HWY_INLINE V rounding_of(const SimdGrid& grid, const Corner<V>& c, const Corner<V>& d) {
        const auto largest = [](V begin, V delta) HWY_ATTR {
            if constexpr (kMoving) return hn::Max(hn::Abs(begin), hn::Abs(begin + delta));
            return hn::Abs(begin);
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
