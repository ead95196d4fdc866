// SPDX-License-Identifier: GPL-3.0-or-later
// Where a micropolygon is while the samples of ranks look: included once a SIMD target inside its
// namespace, after tile_bounds.inl.

/// Where a micropolygon is while the samples of a rank look, a vector of ranks.
struct RankPaths {
    alignas(64) int x0[kPacket], x1[kPacket], y0[kPacket], y1[kPacket];  ///< blocks, inclusive
    /// On an axis: it stays within `reach` of place + speed t + shear u for a sample's t and u.
    struct Axis {
        alignas(64) float place[kPacket], speed[kPacket], shear[kPacket], reach[kPacket];
    } x, y;
};

/// A grid over the ranks of a tile.
class RankPathFinder {
  public:
    RankPathFinder(const SimdGrid& grid, const SimdTile& tile) : m_grid(grid), m_tile(tile) {}

    /// Where the micropolygon can meet the samples of each of these ranks, and which of the ranks
    /// have any that do not see something nearer.  For a fixed lens point a corner moves
    /// monotonically between the ends of its interval of time, whatever the perspective, and for a
    /// fixed time linearly in the lens point (compare Laine et al. 2011): its extremes are at the
    /// corners of the stratum.
    template <bool kMoving, bool kLens>
    HWY_INLINE M find(const Shape& shape, int segment, int first, bool cull, RankPaths& out) const {
        const RankBounds& bounds = *m_tile.bounds;
        const auto rank = [&](const std::vector<float>& values)
                              HWY_ATTR { return hn::LoadU(kTag, values.data() + first); };
        const V zero = set(0.0f), one = set(1.0f);
        M present = hn::Le(rank(bounds.t_lo), rank(bounds.t_hi));
        V ends[2] = {zero, zero};
        const V knots = set(static_cast<float>(m_grid.segments));
        const V start = set(static_cast<float>(segment));
        if constexpr (kMoving) {
            const V lo = rank(bounds.t_lo) * knots - start, hi = rank(bounds.t_hi) * knots - start;
            present = hn::And(present, hn::And(hn::Ge(hi, zero), hn::Le(lo, one)));
            ends[0] = hn::Max(lo, zero);
            ends[1] = hn::Min(hi, one);
        }
        Extent x, y, shear;
        V z_lo = set(INFINITY), margin = zero, bend_x = zero, bend_y = zero;
        M sane = present;
        for (int k = 0; k < 4; ++k) {
            const Corner<float>& c = shape.begin[k];
            const float rounding = rounding_of<kMoving>(shape, k);
            V was_x = zero, was_y = zero, was_w = zero, most = zero;
            for (int e = 0; e < (kMoving ? 2 : 1); ++e) {
                V h_x = set(c.x), h_y = set(c.y), w = set(c.w), z = set(c.z);
                if constexpr (kMoving) {
                    const Corner<float>& d = shape.delta[k];
                    h_x = h_x + ends[e] * set(d.x);
                    h_y = h_y + ends[e] * set(d.y);
                    w = w + ends[e] * set(d.w);
                    z = z + ends[e] * set(d.z);
                }
                const V inverse = one / w;
                const V at_x = h_x * inverse, at_y = h_y * inverse;
                x.add(at_x, e);
                y.add(at_y, e);
                if constexpr (kLens) shear.add((z * set(m_grid.inverse_focus) - one) * inverse, 0);
                z_lo = hn::Min(z_lo, z);
                margin = hn::Max(margin, set(rounding) * inverse);
                sane = hn::And(sane, hn::Gt(w, set(1e-15f)));
                most = hn::Max(most, inverse);
                if (e == 1) {
                    // A path in perspective leaves its chord by at most |chord| |dw| / (4 w).
                    const V curved = hn::Abs(w - was_w) * most * set(0.25f);
                    bend_x = hn::Max(bend_x, hn::Abs(at_x - was_x) * curved);
                    bend_y = hn::Max(bend_y, hn::Abs(at_y - was_y) * curved);
                }
                was_x = at_x;
                was_y = at_y;
                was_w = w;
            }
        }
        const V share = set(1.0f / static_cast<float>(std::max(1, m_grid.segments)));
        const V time0 = (ends[0] + start) * share, time1 = (ends[1] + start) * share;
        const auto axis = [&](const Extent& at, V bend, const std::vector<float>& lens_lo,
                              const std::vector<float>& lens_hi, RankPaths::Axis& to, V& lo,
                              V& hi) HWY_ATTR {
            const V begin = (at.lo[0] + at.hi[0]) * set(0.5f);
            V reach = (at.hi[0] - at.lo[0]) * set(0.5f), place = begin;
            lo = at.lo[0];
            hi = at.hi[0];
            if constexpr (kMoving) {
                const V end = (at.lo[1] + at.hi[1]) * set(0.5f), span = time1 - time0;
                reach = hn::Max(reach, (at.hi[1] - at.lo[1]) * set(0.5f)) + bend;
                lo = hn::Min(lo, at.lo[1]);
                hi = hn::Max(hi, at.hi[1]);
                const M long_enough = hn::Gt(span, set(1e-6f));
                const V speed = hn::IfThenElseZero(long_enough, (end - begin) / span);
                reach = hn::IfThenElse(long_enough, reach, reach + hn::Abs(end - begin));
                place = begin - speed * time0;
                reach = reach + (hn::Abs(place) + hn::Abs(speed)) * set(0x1p-20f);
                hn::StoreU(hn::IfThenElseZero(sane, speed), kTag, to.speed);
            }
            if constexpr (kLens) {
                const V u_lo = rank(lens_lo), u_hi = rank(lens_hi);
                const V middle = (shear.lo[0] + shear.hi[0]) * set(0.5f);
                const V rest =
                    (shear.hi[0] - shear.lo[0]) * set(0.5f) + hn::Abs(middle) * set(0x1p-20f);
                const V far = hn::Max(hn::Abs(u_lo), hn::Abs(u_hi));
                reach = reach + far * rest;
                const V a = shear.lo[0] * u_lo, b = shear.lo[0] * u_hi;
                const V c = shear.hi[0] * u_lo, d = shear.hi[0] * u_hi;
                lo = lo + hn::Min(hn::Min(a, b), hn::Min(c, d));
                hi = hi + hn::Max(hn::Max(a, b), hn::Max(c, d));
                hn::StoreU(hn::IfThenElseZero(sane, middle), kTag, to.shear);
            }
            reach = reach + margin;
            lo = lo - margin;
            hi = hi + margin;
            sane = hn::And(sane, hn::Lt(reach + hn::Abs(lo) + hn::Abs(hi), set(1e15f)));
            hn::StoreU(place, kTag, to.place);
            hn::StoreU(reach, kTag, to.reach);
        };
        V x_lo, x_hi, y_lo, y_hi;
        axis(x, bend_x, bounds.u_lo, bounds.u_hi, out.x, x_lo, x_hi);
        axis(y, bend_y, bounds.v_lo, bounds.v_hi, out.y, y_lo, y_hi);
        if (HWY_UNLIKELY(!hn::AllTrue(kTag, hn::Or(sane, hn::Not(present))))) {
            // At or behind the eye plane: anywhere.
            const V never = set(INFINITY);
            for (RankPaths::Axis* to : {&out.x, &out.y}) {
                hn::StoreU(hn::IfThenElseZero(sane, hn::LoadU(kTag, to->place)), kTag, to->place);
                hn::StoreU(hn::IfThenElse(sane, hn::LoadU(kTag, to->reach), never), kTag,
                           to->reach);
            }
            x_lo = hn::IfThenElse(sane, x_lo, hn::Neg(never));
            y_lo = hn::IfThenElse(sane, y_lo, hn::Neg(never));
            x_hi = hn::IfThenElse(sane, x_hi, never);
            y_hi = hn::IfThenElse(sane, y_hi, never);
        }
        present = hn::And(present, store_blocks(m_tile, x_lo, x_hi, y_lo, y_hi, out));
        if (!cull || hn::AllFalse(kTag, present)) return present;
        // The key of a sample may round a few ulp past the nearest corner's.
        V nearest = hn::Neg(z_lo);
        if (m_grid.range.perspective)
            nearest = hn::IfThenElse(hn::Gt(z_lo, zero), one / z_lo, set(INFINITY));
        return hn::AndNot(hidden(nearest + hn::Abs(nearest) * set(0x1p-18f), first, out), present);
    }

  private:
    /// Extremes of corners at the ends of an interval of time.
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
    };

    /// Whether all samples of the blocks see something nearer, by the hierarchical depth of the
    /// ranks; only where the blocks lie in at most two by two of its squares.
    HWY_INLINE M hidden(V nearest, int first, const RankPaths& blocks) const {
        const auto square = [&](const int* block) HWY_ATTR {
            return hn::ShiftRightSame(hn::LoadU(kIntTag, block), m_tile.square_shift);
        };
        const auto x0 = square(blocks.x0), x1 = square(blocks.x1);
        const auto y0 = square(blocks.y0), y1 = square(blocks.y1);
        const auto two = hn::Set(kIntTag, 2);
        const auto few = hn::And(hn::Lt(x1 - x0, two), hn::Lt(y1 - y0, two));
        const auto wide = hn::Set(kIntTag, m_tile.squares_wide);
        const auto ranks = hn::Set(kIntTag, m_tile.ranks);
        // Lanes without blocks may lie outside.
        const auto safe = hn::Set(kIntTag, 0), most = wide - hn::Set(kIntTag, 1);
        const auto farthest = [&](auto x, auto y) HWY_ATTR {
            x = hn::Min(hn::Max(x, safe), most);
            y = hn::Min(hn::Max(y, safe), most);
            return hn::GatherIndex(kTag, m_tile.farthest_of_ranks + first,
                                   (y * wide + x) * ranks + hn::Iota(kIntTag, 0));
        };
        const V least = hn::Min(hn::Min(farthest(x0, y0), farthest(x1, y0)),
                                hn::Min(farthest(x0, y1), farthest(x1, y1)));
        return hn::And(hn::RebindMask(kTag, few), hn::Lt(nearest, least));
    }

    /// More than a corner's offset from a sample of the tile can round by, times w.
    template <bool kMoving>
    float rounding_of(const Shape& shape, int k) const {
        const Corner<float>& a = shape.begin[k];
        const Corner<float> b = kMoving ? load_end(shape, k) : a;
        const float place = std::max(std::max(std::fabs(a.x), std::fabs(b.x)),
                                     std::max(std::fabs(a.y), std::fabs(b.y)));
        const float depth = std::max(std::fabs(a.z), std::fabs(b.z)) * m_grid.inverse_focus + 1.0f;
        return std::max(std::fabs(a.w), std::fabs(b.w)) / 256 + place * 0x1p-20f +
               std::max(m_grid.lens_x, m_grid.lens_y) * depth * 0x1p-20f;
    }
    static Corner<float> load_end(const Shape& shape, int k) {
        const Corner<float>&a = shape.begin[k], &d = shape.delta[k];
        return {a.x + d.x, a.y + d.y, a.w + d.w, a.z + d.z};
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
};
