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

#include "hider/tile_bounds.inl"

class Kernel {
  public:
    Kernel(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
           SimdCounts& counts)
        : m_grid(grid),
          m_tile(tile),
          m_fragments(fragments),
          m_counts(counts),
          m_where(grid, tile) {}

    template <bool kMoving, bool kLens>
    void run() {
        BlockRanges ranges;
        for (int& segment = m_where.segment; segment < std::max(1, m_grid.segments); ++segment)
            for (int j = 0; j < m_grid.n_v; ++j)
                for (int i = 0; i < m_grid.n_u; i += lane_count()) {
                    const int first = j * m_grid.up + i;
                    M touching = m_where.find_touched(first, m_grid.n_u - i, ranges);
                    if (kMoving && m_tile.strata > 1 && !hn::AllFalse(kTag, touching))
                        touching = hn::And(touching, m_where.find_times<kLens>(first, ranges));
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
    template <bool kMoving, bool kLens>
    HWY_INLINE void hide(int vertex, const BlockRanges& swept, int lane) {
        const Shape shape = m_where.load_shape(vertex);
        if (!(kMoving || kLens) || m_tile.strata == 1) {
            visit_blocks<kMoving, kLens>(shape, swept, lane, 0, m_tile.packets);
            return;
        }
        BlockRanges strata;
        for (int first = 0; first < m_tile.packets; first += lane_count()) {
            M touching = m_where.bound_strata<kMoving, kLens>(shape, first, strata);
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

    /// Time of the samples in the segment, which may lie outside [0, 1].
    HWY_INLINE V local_time(std::size_t i) const {
        return hn::LoadU(kTag, m_tile.t + i) * set(static_cast<float>(m_grid.segments)) -
               set(static_cast<float>(m_where.segment));
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
            if (m_where.segment + 1 < m_grid.segments)
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
        // Where surfaces coincide, neighbours see the same two.
        SurfaceId last = kNoSurface;
        bool wins = false;
        for_each_lane(equal, [&](int lane) {
            SurfaceId& id = m_tile.id[first + lane];
            if (id == kNoSurface) return;
            if (id != last) wins = m_grid.pool->before(m_id, id);
            last = id;
            if (wins) id = m_id;
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
    TileBounds m_where;
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
