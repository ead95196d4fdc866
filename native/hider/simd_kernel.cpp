// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd_kernel.h"

#include <algorithm>
#include <cmath>

#include "hider/micropolygon_class.h"
#include "hider/sample_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/simd_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "hider/corner_arithmetic.inl"

// At most a packet wide, on machines with wider vectors too.
using Tag = hn::CappedTag<float, kPacket>;
using IdTag = hn::RebindToUnsigned<Tag>;
using IntTag = hn::RebindToSigned<Tag>;
using V = hn::Vec<Tag>;
using M = hn::Mask<Tag>;
constexpr Tag kTag;
constexpr IdTag kIdTag;
constexpr IntTag kIntTag;
inline int lane_count() {
    return static_cast<int>(hn::Lanes(kTag));
}
HWY_INLINE V set(float x) {
    return hn::Set(kTag, x);
}

/// Calls visit(lane) for every lane of the mask.
template <class Visit>
HWY_INLINE void for_each_lane(M mask, Visit visit) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kTag, mask, bytes);
    std::uint32_t bits = bytes[0] | (bytes[1] << 8);
    for (; bits != 0; bits &= bits - 1) visit(static_cast<int>(__builtin_ctz(bits)));
}

/// Rectangles of blocks, inclusive, and nearest keys, a vector of them.
struct BlockRanges {
    alignas(64) int x0[kPacket], x1[kPacket], y0[kPacket], y1[kPacket];
    alignas(64) float nearest[kPacket];
};

/// A micropolygon during one segment of its motion.
struct Shape {
    Corner<float> begin[4], delta[4];
};

class Kernel {
  public:
    Kernel(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
           SimdCounts& counts)
        : m_grid(grid),
          m_tile(tile),
          m_fragments(fragments),
          m_counts(counts),
          m_blocks_per_pixel(static_cast<float>(tile.blocks_wide) / kTileSize) {}

    template <bool kMoving, bool kLens>
    void run() {
        const int stride = m_grid.n_u + 1;
        BlockRanges ranges;
        for (m_segment = 0; m_segment < std::max(1, m_grid.segments); ++m_segment)
            for (int j = 0; j < m_grid.n_v; ++j)
                for (int i = 0; i < m_grid.n_u; i += lane_count()) {
                    const int first = j * stride + i;
                    const M touching = find_touched(first, m_grid.n_u - i, ranges);
                    for_each_lane(touching, [&](int lane) HWY_ATTR {
                        const int m = j * m_grid.n_u + i + lane;
                        m_class = m_grid.classes[m];
                        if (m_class == 0) return;
                        m_id = m_grid.base + static_cast<SurfaceId>(m);
                        hide<kMoving, kLens>(first + lane, ranges, lane);
                    });
                }
    }

  private:
    /// Of the micropolygons from this vertex on, which touch the tile, and where over the whole
    /// segment and lens.
    HWY_INLINE M find_touched(int vertex, int count, BlockRanges& out) const {
        const std::size_t at = static_cast<std::size_t>(m_segment) * m_grid.vertices + vertex;
        const std::size_t above = at + static_cast<std::size_t>(m_grid.n_u) + 1;
        const auto least = [&](const float* a) HWY_ATTR {
            return hn::Min(hn::Min(hn::LoadU(kTag, a + at), hn::LoadU(kTag, a + at + 1)),
                           hn::Min(hn::LoadU(kTag, a + above), hn::LoadU(kTag, a + above + 1)));
        };
        const auto most = [&](const float* a) HWY_ATTR {
            return hn::Max(hn::Max(hn::LoadU(kTag, a + at), hn::LoadU(kTag, a + at + 1)),
                           hn::Max(hn::LoadU(kTag, a + above), hn::LoadU(kTag, a + above + 1)));
        };
        hn::StoreU(most(m_grid.nearest), kTag, out.nearest);
        const M some = store_blocks(least(m_grid.x_lo), most(m_grid.x_hi), least(m_grid.y_lo),
                                    most(m_grid.y_hi), out);
        return hn::And(some, hn::FirstN(kTag, static_cast<std::size_t>(count)));
    }

    /// Raster bounds -> blocks; which of them are in the tile.
    HWY_INLINE M store_blocks(V x_lo, V x_hi, V y_lo, V y_hi, BlockRanges& out) const {
        const V scale = set(m_blocks_per_pixel), zero = set(0.0f);
        const V last = set(static_cast<float>(m_tile.blocks_wide - 1));
        const V end = set(static_cast<float>(m_tile.blocks_wide));
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

    template <bool kMoving, bool kLens>
    HWY_INLINE void hide(int vertex, const BlockRanges& swept, int lane) {
        const int corner[4] = {vertex, vertex + 1, vertex + m_grid.n_u + 2,
                               vertex + m_grid.n_u + 1};
        Shape shape;
        for (int k = 0; k < 4; ++k) {
            shape.begin[k] = load(corner[k], m_segment);
            if constexpr (kMoving) {
                const Corner<float> a = shape.begin[k], b = load(corner[k], m_segment + 1);
                shape.delta[k] = {b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z};
            }
        }
        if (!(kMoving || kLens) || m_tile.strata == 1) {
            visit_blocks<kMoving, kLens>(shape, swept, lane, 0, m_tile.packets);
            return;
        }
        BlockRanges strata;
        for (int first = 0; first < m_tile.packets; first += lane_count()) {
            M touching = bound_strata<kMoving, kLens>(shape, first, strata);
            touching = hn::And(touching,
                               hn::FirstN(kTag, static_cast<std::size_t>(m_tile.packets - first)));
            for_each_lane(touching, [&](int k) HWY_ATTR {
                visit_blocks<kMoving, kLens>(shape, strata, k, first + k, first + k + 1);
            });
        }
    }

    /// Packets [packet, packet_end) of the blocks of ranges[lane].
    template <bool kMoving, bool kLens>
    HWY_INLINE void visit_blocks(const Shape& shape, const BlockRanges& ranges, int lane,
                                 int packet, int packet_end) {
        const float nearest = ranges.nearest[lane];
        const int x0 = ranges.x0[lane], x1 = ranges.x1[lane], y1 = ranges.y1[lane];
        for (int by = ranges.y0[lane]; by <= y1; ++by)
            for (int bx = x0; bx <= x1; ++bx) {
                const std::size_t block = static_cast<std::size_t>(by) * m_tile.blocks_wide + bx;
                for (int k = packet; k < packet_end; ++k) {
                    const std::size_t p = block * m_tile.packets + k;
                    if (nearest < m_tile.farthest[p]) {
                        m_counts.culled += kPacket;
                        continue;
                    }
                    m_counts.tests += kPacket;
                    for (int l = 0; l < kPacket; l += lane_count())
                        test<kMoving, kLens>(shape, p * kPacket + l);
                }
            }
    }

    Corner<float> load(int vertex, int knot) const {
        const std::size_t i = static_cast<std::size_t>(knot) * m_grid.vertices + vertex;
        return {m_grid.x[i], m_grid.y[i], m_grid.w[i], m_grid.z[i]};
    }

    /// Where the micropolygon can be while the samples of each of these strata look.  For a fixed
    /// lens point a corner moves monotonically between the ends of its interval of time, whatever
    /// the perspective, and for a fixed time linearly in the lens point (compare Laine et al.
    /// 2011): its extremes are at the corners of the stratum.
    template <bool kMoving, bool kLens>
    HWY_INLINE M bound_strata(const Shape& shape, int first, BlockRanges& out) const {
        const PacketBounds& bounds = *m_tile.bounds;
        const V zero = set(0.0f), one = set(1.0f), many = set(1e15f);
        M present = hn::Ge(zero, zero);
        V ends[2] = {zero, zero};
        if constexpr (kMoving) {
            const V knots = set(static_cast<float>(m_grid.segments));
            const V start = set(static_cast<float>(m_segment));
            const V lo = hn::LoadU(kTag, bounds.t_lo.data() + first) * knots - start;
            const V hi = hn::LoadU(kTag, bounds.t_hi.data() + first) * knots - start;
            present = hn::And(hn::Ge(hi, zero), hn::Le(lo, one));
            ends[0] = hn::Max(lo, zero);
            ends[1] = hn::Min(hi, one);
        }
        V x_lo = set(INFINITY), y_lo = x_lo, z_lo = x_lo, x_hi = set(-INFINITY), y_hi = x_hi;
        V margin = zero;
        M sane = present;
        for (int k = 0; k < 4; ++k) {
            const Corner<float>& c = shape.begin[k];
            const float rounding = rounding_of<kMoving>(shape, k);
            for (int e = 0; e < (kMoving ? 2 : 1); ++e) {
                V x = set(c.x), y = set(c.y), w = set(c.w), z = set(c.z);
                if constexpr (kMoving) {
                    const Corner<float>& d = shape.delta[k];
                    x = x + ends[e] * set(d.x);
                    y = y + ends[e] * set(d.y);
                    w = w + ends[e] * set(d.w);
                    z = z + ends[e] * set(d.z);
                }
                const V inverse = one / w;
                V x0 = x * inverse, y0 = y * inverse, x1 = x0, y1 = y0;
                if constexpr (kLens) {
                    const V shear = (z * set(m_grid.inverse_focus) - one) * inverse;
                    stretch(shear, bounds.u_lo.data() + first, bounds.u_hi.data() + first, x0, x1);
                    stretch(shear, bounds.v_lo.data() + first, bounds.v_hi.data() + first, y0, y1);
                }
                x_lo = hn::Min(x_lo, x0);
                x_hi = hn::Max(x_hi, x1);
                y_lo = hn::Min(y_lo, y0);
                y_hi = hn::Max(y_hi, y1);
                z_lo = hn::Min(z_lo, z);
                margin = hn::Max(margin, set(rounding) * inverse);
                const V far =
                    hn::Max(hn::Max(hn::Abs(x0), hn::Abs(x1)), hn::Max(hn::Abs(y0), hn::Abs(y1)));
                sane = hn::And(sane, hn::And(hn::Gt(w, set(1e-15f)), hn::Lt(far, many)));
            }
        }
        // At or behind the eye plane: anywhere.
        x_lo = hn::IfThenElse(sane, x_lo - margin, set(-INFINITY));
        y_lo = hn::IfThenElse(sane, y_lo - margin, set(-INFINITY));
        x_hi = hn::IfThenElse(sane, x_hi + margin, set(INFINITY));
        y_hi = hn::IfThenElse(sane, y_hi + margin, set(INFINITY));
        // The key of a sample may round a few ulp past the nearest corner's.
        V nearest = hn::Neg(z_lo);
        if (m_grid.range.perspective)
            nearest = hn::IfThenElse(hn::Gt(z_lo, zero), one / z_lo, set(INFINITY));
        hn::StoreU(nearest + hn::Abs(nearest) * set(0x1p-18f), kTag, out.nearest);
        return hn::And(present, store_blocks(x_lo, x_hi, y_lo, y_hi, out));
    }

    static HWY_INLINE void stretch(V shear, const float* lens_lo, const float* lens_hi, V& lo,
                                   V& hi) {
        const V a = shear * hn::LoadU(kTag, lens_lo), b = shear * hn::LoadU(kTag, lens_hi);
        lo = lo + hn::Min(a, b);
        hi = hi + hn::Max(a, b);
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

    /// Time of the samples in the segment, which may lie outside [0, 1].
    HWY_INLINE V local_time(std::size_t i) const {
        return hn::LoadU(kTag, m_tile.t + i) * set(static_cast<float>(m_grid.segments)) -
               set(static_cast<float>(m_segment));
    }

    template <bool kMoving>
    static HWY_INLINE Corner<V> corner_at(const Shape& shape, int k, V local) {
        const Corner<float>& b = shape.begin[k];
        const Corner<V> begin{set(b.x), set(b.y), set(b.w), set(b.z)};
        if constexpr (!kMoving) return begin;
        const Corner<float>& d = shape.delta[k];
        return at_time(begin, {set(d.x), set(d.y), set(d.w), set(d.z)}, local);
    }

    template <bool kLens>
    HWY_INLINE Offset<V> offset(const Corner<V>& c, std::size_t i) const {
        const V x = hn::LoadU(kTag, m_tile.x + i), y = hn::LoadU(kTag, m_tile.y + i);
        if constexpr (kLens)
            return offset_lens(c, x, y, hn::LoadU(kTag, m_tile.u + i),
                               hn::LoadU(kTag, m_tile.v + i), set(m_grid.inverse_focus), set(1.0f));
        else
            return offset_pinhole(c, x, y);
    }

    /// A vector of samples against the micropolygon.
    template <bool kMoving, bool kLens>
    HWY_INLINE void test(const Shape& shape, std::size_t i) {
        const V zero = set(0.0f);
        const V local = kMoving ? local_time(i) : zero;
        const Offset<V> d0 = offset<kLens>(corner_at<kMoving>(shape, 0, local), i);
        const Offset<V> d1 = offset<kLens>(corner_at<kMoving>(shape, 1, local), i);
        const Offset<V> d2 = offset<kLens>(corner_at<kMoving>(shape, 2, local), i);
        const Offset<V> d3 = offset<kLens>(corner_at<kMoving>(shape, 3, local), i);
        const V e01 = edge(d0, d1), e12 = edge(d1, d2), e02 = edge(d0, d2);
        const V e23 = edge(d2, d3), e30 = edge(d3, d0), e20 = hn::Neg(e02);
        M in_a = hn::MaskFromVec(zero), strict_a = in_a, in_b = in_a, strict_b = in_a;
        if (m_class & kTriangleA) inside(e01, e12, e20, in_a, strict_a);
        if (m_class & kTriangleB) inside(e02, e23, e30, in_b, strict_b);
        M touched = hn::Or(in_a, in_b);
        if (hn::AllFalse(kTag, touched)) return;
        if (kMoving && m_grid.segments > 1) {
            touched = hn::And(touched, hn::Ge(local, zero));
            if (m_segment + 1 < m_grid.segments)
                touched = hn::And(touched, hn::Lt(local, set(1.0f)));
        }

        // Strictly inside one triangle and outside the other; the rest is on an edge or where the
        // micropolygon is folded.
        const M clean =
            hn::And(touched, hn::Or(hn::AndNot(in_b, strict_a), hn::AndNot(in_a, strict_b)));
        const V z0 = corner_at<kMoving>(shape, 0, local).z;
        const V z1 = corner_at<kMoving>(shape, 1, local).z;
        const V z2 = corner_at<kMoving>(shape, 2, local).z;
        const V z3 = corner_at<kMoving>(shape, 3, local).z;
        const V first_weight = hn::IfThenElse(strict_a, e12, e23);
        const V second_weight = hn::IfThenElse(strict_a, e20, e30);
        const V third_weight = hn::IfThenElse(strict_a, e01, e02);
        const V second_z = hn::IfThenElse(strict_a, z1, z2);
        const V third_z = hn::IfThenElse(strict_a, z2, z3);
        const V share = set(1.0f) / (first_weight + second_weight + third_weight);
        const V z =
            z0 + second_weight * share * (second_z - z0) + third_weight * share * (third_z - z0);
        const V z_in = hn::Min(hn::Max(z, hn::Min(z0, hn::Min(second_z, third_z))),
                               hn::Max(z0, hn::Max(second_z, third_z)));
        V key = m_grid.range.perspective ? set(1.0f) / z_in : hn::Neg(z_in);
        M hit = hn::And(clean, hn::And(hn::Ge(key, set(m_grid.range.key_far)),
                                       hn::Le(key, set(m_grid.range.key_near))));
        const M unclear = hn::AndNot(clean, touched);
        if (HWY_UNLIKELY(!hn::AllFalse(kTag, unclear))) {
            // By way of memory: what a call can see would be kept there in every test.
            alignas(64) float keys[kPacket], hits[kPacket];
            hn::StoreU(key, kTag, keys);
            hn::StoreU(hn::IfThenElseZero(hit, set(1.0f)), kTag, hits);
            test_exactly<kMoving, kLens>(shape, i, unclear, keys, hits);
            key = hn::LoadU(kTag, keys);
            hit = hn::Gt(hn::LoadU(kTag, hits), zero);
        }
        if (!hn::AllFalse(kTag, hit)) record(key, hit, i);
    }

    static HWY_INLINE void inside(V a, V b, V c, M& in, M& strict) {
        const V zero = set(0.0f);
        const V least = hn::Min(hn::Min(a, b), c), most = hn::Max(hn::Max(a, b), c);
        in = hn::Or(hn::Ge(least, zero), hn::Le(most, zero));
        strict = hn::Or(hn::Gt(least, zero), hn::Lt(most, zero));
    }

    template <bool kMoving, bool kLens>
    HWY_NOINLINE void test_exactly(const Shape& shape, std::size_t i, M unclear, float* keys,
                                   float* hits) {
        const V local = kMoving ? local_time(i) : set(0.0f);
        alignas(64) float values[4][4][kPacket];
        for (int k = 0; k < 4; ++k) {
            const Corner<V> c = corner_at<kMoving>(shape, k, local);
            const Offset<V> d = offset<kLens>(c, i);
            hn::StoreU(d.x, kTag, values[k][0]);
            hn::StoreU(d.y, kTag, values[k][1]);
            hn::StoreU(c.w, kTag, values[k][2]);
            hn::StoreU(c.z, kTag, values[k][3]);
        }
        for_each_lane(unclear, [&](int lane) {
            granita::Corner<double> corner[4];
            granita::Offset<double> offset[4];
            for (int k = 0; k < 4; ++k) {
                offset[k] = {values[k][0][lane], values[k][1][lane]};
                corner[k] = {0.0, 0.0, values[k][2][lane], values[k][3][lane]};
            }
            const SurfaceHit exact = hit_micropolygon(corner, offset, m_class, m_grid.range);
            keys[lane] = exact.key;
            hits[lane] = exact.hit ? 1.0f : 0.0f;
        });
    }

    HWY_INLINE void record(V key, M hit, std::size_t first) {
        m_counts.hits += hn::CountTrue(kTag, hit);
        const V stored = hn::LoadU(kTag, m_tile.key + first);
        const M nearer = hn::And(hit, hn::Gt(key, stored));
        const M equal = hn::And(hit, hn::Eq(key, stored));
        if (m_class & kTransparent) {
            record_fragments(key, hn::Or(nearer, equal), equal, first);
            return;
        }
        if (HWY_UNLIKELY(!hn::AllFalse(kTag, equal))) settle_ties(equal, first);
        if (hn::AllFalse(kTag, nearer)) return;
        m_counts.writes += hn::CountTrue(kTag, nearer);
        hn::BlendedStore(key, nearer, kTag, m_tile.key + first);
        hn::BlendedStore(hn::Set(kIdTag, m_id), hn::RebindMask(kIdTag, nearer), kIdTag,
                         m_tile.id + first);
    }

    HWY_NOINLINE void settle_ties(M equal, std::size_t first) {
        for_each_lane(equal, [&](int lane) {
            SurfaceId& id = m_tile.id[first + lane];
            if (id != kNoSurface && m_grid.pool->before(m_id, id)) id = m_id;
        });
    }

    HWY_NOINLINE void record_fragments(V key, M visible, M equal, std::size_t first) {
        alignas(64) float keys[16], ties[16];
        hn::StoreU(key, kTag, keys);
        hn::StoreU(hn::IfThenElseZero(equal, set(1.0f)), kTag, ties);
        for_each_lane(visible, [&](int lane) {
            const SurfaceId stored = m_tile.id[first + lane];
            if (ties[lane] > 0.0f && (stored == kNoSurface || !m_grid.pool->before(m_id, stored)))
                return;
            m_fragments.push_back({keys[lane], static_cast<std::uint32_t>(first + lane), m_id});
        });
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
    std::vector<Fragment>& m_fragments;
    SimdCounts& m_counts;
    const float m_blocks_per_pixel;
    int m_segment = 0;
    std::uint8_t m_class = 0;
    SurfaceId m_id = 0;
};

void hide_grid(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
               SimdCounts& counts) {
    Kernel kernel(grid, tile, fragments, counts);
    const bool lens = grid.lens_x > 0.0f;
    if (grid.segments > 0)
        lens ? kernel.run<true, true>() : kernel.run<true, false>();
    else
        lens ? kernel.run<false, true>() : kernel.run<false, false>();
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(hide_grid);

void hide_grid_in_tile(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
                       SimdCounts& counts) {
    HWY_DYNAMIC_DISPATCH(hide_grid)(grid, tile, fragments, counts);
}

}  // namespace granita
#endif
