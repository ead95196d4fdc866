// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "hider/micropolygon_class.h"
#include "hider/rank_bounds.h"
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
#include "hider/packet_vectors.inl"
#include "hider/sample_packet.inl"

/// Calls visit(lane) for every lane of the mask.
template <class Visit>
HWY_INLINE void for_each_lane(M mask, Visit visit) {
    for (std::uint32_t bits = bits_of(mask); bits != 0; bits &= bits - 1)
        visit(static_cast<int>(__builtin_ctz(bits)));
}

#include "hider/path_extents.inl"
#include "hider/squeeze.inl"
#include "hider/tile_bounds.inl"
#include "hider/tile_paths.inl"
#include "hider/triangle_pair.inl"
#include "hider/vector_fragments.inl"

class Kernel {
  public:
    Kernel(const SimdGrid& grid, const SimdTile& tile, FragmentLists& lists, SimdCounts& counts)
        : m_grid(grid),
          m_tile(tile),
          m_lists(lists),
          m_counts(counts),
          m_where(grid, tile),
          m_paths(grid, tile),
          m_appears(!grid.lifespan.is_whole()) {
        for (int i = 0; i < kPacket; ++i)
            m_window[i] = i / kWindow * tile.blocks_wide + i % kWindow;
    }

    template <Lens kLens>
    void run() {
        m_grid.segments > 0 ? run<true, kLens>() : run<false, kLens>();
    }

  private:
    template <bool kMoving, Lens kLens>
    void run() {
        BlockRanges ranges;
        for (int& segment = m_where.segment; segment < std::max(1, m_grid.segments); ++segment)
            for (int j = 0; j < m_grid.n_v; ++j)
                for (int i = 0; i < m_grid.n_u; i += lane_count()) {
                    const int first = j * m_grid.up + i;
                    M touching = m_where.find_touched(first, m_grid.n_u - i, ranges);
                    if (kMoving && !hn::AllFalse(kTag, touching))
                        touching = hn::And(touching, m_where.find_times<kLens>(first, ranges));
                    if ((kMoving || kLens != Lens::None) && !hn::AllFalse(kTag, touching))
                        m_paths.find_paths<kMoving, kLens>(m_where.segment, first, ranges,
                                                           m_tile_paths);
                    for_each_lane(touching, [&](int lane) HWY_ATTR {
                        const int m = j * m_grid.n_u + i + lane;
                        m_class = m_grid.classes[m];
                        if (m_class == 0) return;
                        m_id = m_grid.base + static_cast<SurfaceId>(m);
                        const Shape shape = m_where.load_shape(first + lane);
                        if (kMoving || kLens != Lens::None || m_tile.ranked)
                            visit_ranks<kMoving, kLens>(shape, ranges, lane);
                        else
                            visit_packets(shape, ranges, lane);
                    });
                }
    }

    /// What is still is tested against all packets of the blocks of ranges[lane].
    HWY_INLINE void visit_packets(const Shape& shape, const BlockRanges& ranges, int lane) {
        const float nearest = ranges.nearest[lane];
        const int packets = m_tile.ranks / kPacket;
        const int x0 = ranges.x0[lane], x1 = ranges.x1[lane], y1 = ranges.y1[lane];
        for (int by = ranges.y0[lane]; by <= y1; ++by)
            for (int bx = x0; bx <= x1; ++bx) {
                const std::size_t block = static_cast<std::size_t>(by) * m_tile.blocks_wide + bx;
                for (std::size_t i = block * packets; i < (block + 1) * packets; ++i) {
                    const std::size_t p = m_tile.packets[i];
                    if (nearest < m_tile.farthest_of_packets[p]) continue;
                    m_counts.tests += kPacket;
                    for (int l = 0; l < kPacket; l += lane_count())
                        test_packet(shape, p * kPacket + l);
                }
            }
    }

    HWY_INLINE void test_packet(const Shape& shape, std::size_t first) {
        Samples at;
        at.x = hn::LoadU(kTag, m_tile.x + first);
        at.y = hn::LoadU(kTag, m_tile.y + first);
        Hits hits;
        const M hit = test<false, Lens::None>(shape, at, hn::FirstN(kTag, kPacket), hits);
        if (!hn::AllFalse(kTag, hit)) record(hits, hit, first);
    }

    /// What is swept, and what is still in a tile where other things are swept: ranks are bounded a
    /// vector at a time, the samples in each rank's window of blocks are compared with the
    /// micropolygon's path, and what remains, about twice what is hit, is tested in whole vectors.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void visit_ranks(const Shape& shape, const BlockRanges& swept, int lane) {
        int first = 0, end = m_tile.ranks;
        if constexpr (kMoving) m_where.find_ranks(swept, lane, first, end);
        const bool cull = swept.nearest[lane] < m_tile.nearest_of_ranks;
        const bool straight =
            (kMoving || kLens != Lens::None) && (m_tile_paths.straight >> lane & 1u);
        RankPaths paths;
        std::size_t found = 0;
        for (; first < end; first += lane_count()) {
            M touching =
                straight ? m_paths.follow<kMoving, kLens>(m_tile_paths, lane, m_where.segment,
                                                          first, cull, paths)
                         : m_paths.find<kMoving, kLens>(shape, m_where.segment, first, cull, paths);
            touching = hn::And(touching, hn::FirstN(kTag, static_cast<std::size_t>(end - first)));
            for_each_lane(touching, [&](int k) HWY_ATTR {
                // Windows side by side that do not leave the tile.
                const int wide = m_tile.blocks_wide;
                const int across = (paths.x1[k] - paths.x0[k]) / kWindow + 1;
                const int up = (paths.y1[k] - paths.y0[k]) / kWindow + 1;
                const int x0 = std::min(paths.x0[k], wide - kWindow * across);
                const int y0 = std::min(paths.y0[k], wide - kWindow * up);
                for (int y = 0; y < up; ++y)
                    for (int x = 0; x < across; ++x) {
                        const int slot =
                            ((first + k) * wide + y0 + kWindow * y) * wide + x0 + kWindow * x;
                        found = filter_window<kMoving, kLens>(paths, k, slot, found);
                        if (HWY_UNLIKELY(found > kMostListed)) {
                            test_listed<kMoving, kLens>(shape, found);
                            found = 0;
                        }
                    }
            });
        }
        test_listed<kMoving, kLens>(shape, found);
    }

    /// Rows of kWindow floats, as many as fit a vector.
    template <class D>
    HWY_INLINE hn::Vec<D> load_rows(D d, const float* row) const {
        if constexpr (hn::MaxLanes(d) == kWindow) {
            return hn::LoadU(d, row);
        } else {
            constexpr hn::Half<D> half;
            constexpr int kRows = hn::MaxLanes(d) / kWindow / 2;
            return hn::Combine(d, load_rows(half, row + kRows * m_tile.blocks_wide),
                               load_rows(half, row));
        }
    }

    /// Of the window at `slot`, adds the samples within the micropolygon's reach to the list.
    template <bool kMoving, Lens kLens>
    HWY_INLINE std::size_t filter_window(const RankPaths& paths, int k, int slot,
                                         std::size_t found) {
        constexpr int kRows = hn::MaxLanes(kTag) / kWindow;
        for (int row = 0; row < kWindow; row += kRows, slot += kRows * m_tile.blocks_wide) {
            Samples at;
            at.x = load_rows(kTag, m_tile.x + slot);
            at.y = load_rows(kTag, m_tile.y + slot);
            V x = set(paths.x.place[k]), y = set(paths.y.place[k]);
            if constexpr (kMoving) {
                at.t = load_rows(kTag, m_tile.t + slot);
                x = x + set(paths.x.speed[k]) * at.t;
                y = y + set(paths.y.speed[k]) * at.t;
            }
            if constexpr (kLens != Lens::None) {
                at.u = load_rows(kTag, m_tile.u + slot);
                at.v = load_rows(kTag, m_tile.v + slot);
                V shear = set(paths.shear[k]);
                if constexpr (kLens == Lens::Refocused) {
                    at.inverse_focus = load_rows(kTag, m_tile.inverse_focus + slot);
                    shear = shear + set(paths.depth[k]) * at.inverse_focus;
                }
                x = x + shear * at.u;
                y = y + shear * at.v;
            }
            const M near = hn::And(hn::Le(hn::Abs(at.x - x), set(paths.x.reach[k])),
                                   hn::Le(hn::Abs(at.y - y), set(paths.y.reach[k])));
            const Squeeze squeeze(near);
            const auto add = [&](V value, float* to)
                                 HWY_ATTR { hn::StoreU(squeeze(value), kTag, to + found); };
            at.for_each<kMoving, kLens>([&](V value, int k)
                                            HWY_ATTR { add(value, m_listed.samples[k]); });
            const auto slots = hn::LoadU(kIntTag, m_window) + hn::Set(kIntTag, slot);
            add(hn::BitCast(kTag, slots), m_listed.slot);
            found += squeeze.count();
        }
        return found;
    }

    template <bool kMoving, Lens kLens>
    HWY_INLINE void test_listed(const Shape& shape, std::size_t count) {
        m_counts.tests += count;
        std::size_t covered = 0;
        for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(lane_count())) {
            Samples at;
            at.for_each<kMoving, kLens>([&](V& value, int k) HWY_ATTR {
                value = hn::LoadU(kTag, m_listed.samples[k] + i);
            });
            Hits hits;
            const M hit = test<kMoving, kLens>(shape, at, hn::FirstN(kTag, count - i), hits);
            if (hn::AllFalse(kTag, hit)) continue;
            const Squeeze squeeze(hit);
            hn::StoreU(squeeze(hits.key), kTag, m_hit.key + covered);
            hn::StoreU(squeeze(hn::LoadU(kTag, m_listed.slot + i)), kTag, m_hit.slot + covered);
            if (m_class & kTransparent) {
                hn::StoreU(squeeze(hits.signed_b1), kTag, m_hit.signed_b1 + covered);
                hn::StoreU(squeeze(hits.b2), kTag, m_hit.b2 + covered);
            }
            covered += squeeze.count();
        }
        record_hits(covered);
    }

    /// Time of the samples in the segment, which may lie outside [0, 1].
    HWY_INLINE V local_time(const Samples& at) const {
        return at.t * set(static_cast<float>(m_grid.segments)) -
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

    template <Lens kLens>
    HWY_INLINE Offset<V> offset(const Corner<V>& c, const Samples& at) const {
        const V one = set(1.0f);
        if constexpr (kLens == Lens::None)
            return offset_pinhole(c, at.x, at.y);
        else if constexpr (kLens == Lens::Still)
            return offset_lens(c, at.x, at.y, at.u, at.v, set(m_grid.inverse_focus), one);
        else
            return offset_lens(c, at.x, at.y, at.u, at.v, at.inverse_focus, one);
    }

    /// Where a vector of samples meets the micropolygon; weights as in Fragment.
    struct Hits {
        V key, signed_b1, b2;
    };
    /// The same by way of memory, with the samples' coordinates as far as there are.
    struct Exact {
        alignas(64) float key[kPacket], hit[kPacket], signed_b1[kPacket], b2[kPacket];
        alignas(64) float samples[Samples::kCoordinates][kPacket];
    };

    /// A vector of samples against the micropolygon: which it covers, and where.
    template <bool kMoving, Lens kLens>
    HWY_INLINE M test(const Shape& shape, Samples at, M valid, Hits& hits) {
        const V zero = set(0.0f);
        const V local = kMoving ? local_time(at) : zero;
        const Offset<V> d0 = offset<kLens>(corner_at<kMoving>(shape, 0, local), at);
        const Offset<V> d1 = offset<kLens>(corner_at<kMoving>(shape, 1, local), at);
        const Offset<V> d2 = offset<kLens>(corner_at<kMoving>(shape, 2, local), at);
        const Offset<V> d3 = offset<kLens>(corner_at<kMoving>(shape, 3, local), at);
        const PairEdges e = edges_of(d0, d1, d2, d3);
        const M never = hn::MaskFromVec(zero);
        Side a{never, never}, b{never, never};
        if (m_class & kTriangleA) a = first_side(e);
        if (m_class & kTriangleB) b = second_side(e);
        M touched = hn::And(valid, hn::Or(a.in, b.in));
        if (hn::AllFalse(kTag, touched)) return touched;
        if (kMoving && m_grid.segments > 1) {
            touched = hn::And(touched, hn::Ge(local, zero));
            if (m_where.segment + 1 < m_grid.segments)
                touched = hn::And(touched, hn::Lt(local, set(1.0f)));
        }
        if (kMoving && m_appears)
            touched = hn::And(touched, hn::And(hn::Ge(at.t, set(m_grid.lifespan.open)),
                                               hn::Lt(at.t, set(m_grid.lifespan.close))));
        const M clean = hn::And(touched, is_clean(a, b));
        const V z0 = corner_at<kMoving>(shape, 0, local).z;
        const V z1 = corner_at<kMoving>(shape, 1, local).z;
        const V z2 = corner_at<kMoving>(shape, 2, local).z;
        const V z3 = corner_at<kMoving>(shape, 3, local).z;
        const PairWeights weights = weights_of(e, a.strict);
        const V second_z = hn::IfThenElse(a.strict, z1, z2);
        const V third_z = hn::IfThenElse(a.strict, z2, z3);
        const V z = z0 + weights.second * (second_z - z0) + weights.third * (third_z - z0);
        const V z_in = hn::Min(hn::Max(z, hn::Min(z0, hn::Min(second_z, third_z))),
                               hn::Max(z0, hn::Max(second_z, third_z)));
        hits.key = m_grid.range.perspective ? set(1.0f) / z_in : hn::Neg(z_in);
        M hit = hn::And(clean, hn::And(hn::Ge(hits.key, set(m_grid.range.key_far)),
                                       hn::Le(hits.key, set(m_grid.range.key_near))));
        hits.signed_b1 = hn::IfThenElse(a.strict, weights.second, hn::Neg(weights.second));
        hits.b2 = weights.third;
        const M unclear = hn::AndNot(clean, touched);
        if (HWY_UNLIKELY(!hn::AllFalse(kTag, unclear))) {
            // By way of memory: what a call can see would be kept there in every test.
            Exact exact;
            hn::StoreU(hits.key, kTag, exact.key);
            hn::StoreU(hn::IfThenElseZero(hit, set(1.0f)), kTag, exact.hit);
            hn::StoreU(hits.signed_b1, kTag, exact.signed_b1);
            hn::StoreU(hits.b2, kTag, exact.b2);
            at.for_each<kMoving, kLens>(
                [&](V value, int k) HWY_ATTR { hn::StoreU(value, kTag, exact.samples[k]); });
            test_exactly<kMoving, kLens>(shape, unclear, exact);
            hits.key = hn::LoadU(kTag, exact.key);
            hits.signed_b1 = hn::LoadU(kTag, exact.signed_b1);
            hits.b2 = hn::LoadU(kTag, exact.b2);
            hit = hn::Gt(hn::LoadU(kTag, exact.hit), zero);
        }
        return hit;
    }

    template <bool kMoving, Lens kLens>
    HWY_NOINLINE void test_exactly(const Shape& shape, M unclear, Exact& exact) {
        Samples at;
        at.for_each<kMoving, kLens>([&](V& value, int k)
                                        HWY_ATTR { value = hn::LoadU(kTag, exact.samples[k]); });
        const V local = kMoving ? local_time(at) : set(0.0f);
        alignas(64) float values[4][4][kPacket];
        for (int k = 0; k < 4; ++k) {
            const Corner<V> c = corner_at<kMoving>(shape, k, local);
            const Offset<V> d = offset<kLens>(c, at);
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
            const SurfaceHit hit = hit_micropolygon(corner, offset, m_class, m_grid.range);
            const Fragment fragment = fragment_of(hit, m_id);
            exact.key[lane] = fragment.key;
            exact.hit[lane] = hit.hit ? 1.0f : 0.0f;
            exact.signed_b1[lane] = fragment.signed_b1;
            exact.b2[lane] = fragment.b2;
        });
    }

    HWY_INLINE void record(const Hits& hits, M hit, std::size_t first) {
        const V key = hits.key;
        m_counts.hits += hn::CountTrue(kTag, hit);
        const V stored = hn::LoadU(kTag, m_tile.key + first);
        const M nearer = hn::And(hit, hn::Gt(key, stored));
        const M equal = hn::And(hit, hn::Eq(key, stored));
        if (m_class & kTransparent) {
            M visible = nearer;
            if (HWY_UNLIKELY(!hn::AllFalse(kTag, equal))) {
                alignas(64) float wins[kPacket] = {};
                for_each_lane(equal, [&](int lane) {
                    wins[lane] = wins_tie(m_tile.id[first + lane]) ? 1.0f : 0.0f;
                });
                visible = hn::Or(visible, hn::Gt(hn::Load(kTag, wins), set(0.0f)));
            }
            if (hn::AllFalse(kTag, visible)) return;
            m_counts.fragments += hn::CountTrue(kTag, visible);
            const V id = hn::BitCast(kTag, hn::Set(kIdTag, m_id));
            add_fragments({hits.key, id, hits.signed_b1, hits.b2}, visible, first, m_lists);
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
        for_each_lane(equal, [&](int lane) { settle_tie(m_tile.id[first + lane]); });
    }

    HWY_INLINE void settle_tie(SurfaceId& id) {
        if (wins_tie(id)) id = m_id;
    }

    /// Where surfaces coincide, neighbours see the same two.
    HWY_INLINE bool wins_tie(SurfaceId id) {
        if (id == kNoSurface) return false;
        if (id != m_tied[0] || m_id != m_tied[1]) {
            m_tied[0] = id;
            m_tied[1] = m_id;
            m_wins_tie = m_grid.pool->before(m_id, id);
        }
        return m_wins_tie;
    }

    /// Hit i, if it is before the slot's opaque surface.
    HWY_INLINE void record_fragment(std::size_t i, std::size_t slot) {
        const float key = m_hit.key[i];
        if (!(key > m_tile.key[slot] || wins_tie(m_tile.id[slot]))) return;
        Fragment fragment;
        fragment.key = key;
        fragment.id = m_id;
        fragment.signed_b1 = m_hit.signed_b1[i];
        fragment.b2 = m_hit.b2[i];
        m_lists.add(static_cast<std::uint32_t>(slot), fragment);
        ++m_counts.fragments;
    }

    /// Of m_hit, in different places: one after another.
    HWY_INLINE void record_hits(std::size_t count) {
        m_counts.hits += count;
        for (std::size_t i = 0; i < count; ++i) {
            const int slot = std::bit_cast<int>(m_hit.slot[i]);
            const float key = m_hit.key[i];
            float& stored = m_tile.key[slot];
            if (key < stored) continue;
            if (m_class & kTransparent) {
                record_fragment(i, slot);
            } else if (key > stored) {
                ++m_counts.writes;
                stored = key;
                m_tile.id[slot] = m_id;
            } else {
                settle_tie(m_tile.id[slot]);
            }
        }
    }

    static constexpr int kWindow = 4;
    static constexpr std::size_t kMostListed = 256;
    static constexpr std::size_t kListed = kMostListed + 2 * kPacket;

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
    FragmentLists& m_lists;
    SimdCounts& m_counts;
    TileBounds m_where;
    RankPathFinder m_paths;
    TilePaths m_tile_paths;
    const bool m_appears;  ///< or vanishes
    std::uint8_t m_class = 0;
    SurfaceId m_id = 0;
    SurfaceId m_tied[2] = {kNoSurface, kNoSurface};  ///< the last two to settle
    bool m_wins_tie = false;
    struct {
        alignas(64) float samples[Samples::kCoordinates][kListed],
            slot[kListed];  ///< slot: bits of an int
    } m_listed;             ///< samples to be tested
    struct {
        float key[kListed], slot[kListed], signed_b1[kListed], b2[kListed];
    } m_hit;                            ///< samples that were
    alignas(64) int m_window[kPacket];  ///< slots of a vector's rows from the first
};

void hide_grid(const SimdGrid& grid, const SimdTile& tile, FragmentLists& lists,
               SimdCounts& counts) {
    Kernel kernel(grid, tile, lists, counts);
    if (grid.lens_x == 0.0f)
        kernel.run<Lens::None>();
    else if (grid.refocuses())
        kernel.run<Lens::Refocused>();
    else
        kernel.run<Lens::Still>();
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(hide_grid);

void hide_grid_in_tile(const SimdGrid& grid, const SimdTile& tile, FragmentLists& lists,
                       SimdCounts& counts) {
    HWY_DYNAMIC_DISPATCH(hide_grid)(grid, tile, lists, counts);
}

}  // namespace granita
#endif
