// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/simd_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "hider/micropolygon_class.h"
#include "hider/samples/sample_order.h"
#include "hider/simd/rank_bounds.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/simd/simd_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Vectors.
#include "hider/corner_arithmetic.inl"
#include "hider/packet_vectors.inl"
#include "hider/simd/sample_packet.inl"
#include "hider/simd/squeeze.inl"
// Where micropolygons are, and what of them is seen.
#include "hider/simd/path_extents.inl"
#include "hider/simd/shapes.inl"
#include "hider/simd/tile_bounds.inl"
#include "hider/simd/tile_paths.inl"
#include "hider/simd/triangle_pair.inl"
#include "hider/vector_fragments.inl"
// Parts of the kernel.
#include "hider/simd/patch_frame.inl"
#include "hider/simd/rank_windows.inl"
#include "hider/simd/sample_test.inl"
// Those that need them.
#include "hider/simd/flock.inl"
#include "hider/simd/hit_recorder.inl"
#include "hider/simd/near_samples.inl"

class Kernel {
  public:
    Kernel(const SimdGrid& grid, const SimdTile& tile, FragmentLists& lists, SimdCounts& counts)
        : m_grid(grid),
          m_tile(tile),
          m_counts(counts),
          m_where(grid, tile),
          m_paths(grid, tile),
          m_windows(tile),
          m_test(grid, m_target),
          m_recorder(grid, tile, m_target, lists, counts),
          m_patches(grid, m_paths),
          m_flocks(grid, tile, m_where, m_paths),
          m_together(grid.finite && grid.n_u * grid.n_v >= kLeastPatch),
          m_in_flocks(grid.n_v <= kNarrow) {}

    template <Lens kLens>
    void run() {
        m_grid.segments > 0 ? run<true, kLens>() : run<false, kLens>();
    }

  private:
    template <bool kMoving, Lens kLens>
    void run() {
        int& segment = m_target.segment;
        for (segment = 0; segment < std::max(1, m_grid.segments); ++segment) {
            if constexpr (kMoving || kLens != Lens::None) {
                if (m_together && m_in_flocks && m_flocks.pay<kLens>()) {
                    visit_flocks<kMoving, kLens>();
                    continue;
                }
            }
            for (int j0 = 0; j0 < m_grid.n_v; j0 += Patch::kSide)
                for (int i = 0; i < m_grid.n_u; i += kStep) {
                    std::uint32_t loose = ~0u;
                    if constexpr (kMoving || kLens != Lens::None)
                        loose = visit_patches<kMoving, kLens>(i, j0);
                    if (loose == 0) continue;
                    for (int j = j0; j < std::min(j0 + Patch::kSide, m_grid.n_v); ++j)
                        for (int k = 0; k < std::min(kStep, m_grid.n_u - i); k += lane_count())
                            visit_row<kMoving, kLens>(i + k, j, loose >> k);
                }
        }
        if constexpr (kMoving || kLens != Lens::None) test_near<kMoving, kLens>();
    }

    /// The whole grid; what parts is looked at one by one.
    template <bool kMoving, Lens kLens>
    void visit_flocks() {
        const int wide = FlockSlices::kMost / m_grid.n_v;
        for (int i = 0; i < m_grid.n_u; i += wide) {
            const Patch flock{i, 0, std::min(wide, m_grid.n_u - i), m_grid.n_v};
            using Found = PatchFinder::Found;
            const Found found =
                m_flocks.find<kMoving, kLens>(flock, m_target.segment, m_patch, m_slices);
            if (found == Found::Framed) visit_flock<kMoving, kLens>(flock);
            if (found != Found::Loose) continue;
            for (int j = 0; j < flock.n_v; ++j)
                for (int k = 0; k < flock.n_u; k += lane_count())
                    visit_row<kMoving, kLens>(i + k, j, ~0u >> std::max(0, 32 - flock.n_u + k));
        }
    }

    /// A vector of micropolygons from (i, j) on, of which bits of `which` tell whether to look.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void visit_row(int i, int j, std::uint32_t which) {
        BlockRanges ranges;
        const int segment = m_target.segment, first = j * m_grid.up + i;
        M touching = m_where.find_touched(segment, first, m_grid.n_u - i, ranges);
        if (kMoving && !hn::AllFalse(kTag, touching))
            touching = hn::And(touching, m_where.find_times<kLens>(segment, first, ranges));
        if ((kMoving || kLens != Lens::None) && !hn::AllFalse(kTag, touching))
            m_paths.find_paths<kMoving, kLens>(segment, first, ranges, m_tile_paths);
        for_each_bit(bits_of(touching) & which, [&](int lane) HWY_ATTR {
            if (!aim_at(i + lane, j)) return;
            const Shape shape = m_where.load_shape(segment, first + lane, m_target.kind);
            if (kMoving || kLens != Lens::None || m_tile.ranked)
                visit_ranks<kMoving, kLens>(shape, ranges, lane);
            else
                visit_packets(shape, ranges, lane);
        });
    }

    /// False: there is nothing to hit.
    HWY_INLINE bool aim_at(int i, int j) {
        const int m = j * m_grid.n_u + i;
        m_target.kind = m_grid.classes[m];
        m_target.id = m_grid.base + static_cast<SurfaceId>(m);
        return m_target.kind != 0;
    }

    /// The patches of a vector of micropolygons from (i, j) on; which micropolygons are of none.
    template <bool kMoving, Lens kLens>
    HWY_INLINE std::uint32_t visit_patches(int i, int j) {
        if (!m_together || m_in_flocks) return ~0u;
        std::uint32_t loose = 0;
        for (int k = 0; k < kStep && i + k < m_grid.n_u; k += Patch::kSide) {
            const Patch patch{i + k, j, std::min(Patch::kSide, m_grid.n_u - i - k),
                              std::min(Patch::kSide, m_grid.n_v - j)};
            using Found = PatchFinder::Found;
            const Found found = m_patches.find<kMoving, kLens>(patch, m_target.segment, m_patch);
            if (found == Found::Framed) visit_patch<kMoving, kLens>(patch);
            if (found == Found::Loose) loose |= ((1u << Patch::kSide) - 1) << k;
        }
        return loose;
    }

    /// Calls visit(paths, k, samples, their slots, how far they are on x and y from the path) for
    /// the samples of the windows of all ranks that `times`, of `lane`, and find(first rank, paths)
    /// leave; the path is lane k of `paths`.  Ranks are bounded a vector at a time.
    template <bool kMoving, Lens kLens, class Find, class Visit>
    HWY_INLINE void visit_windows(const BlockRanges& times, int lane, Find find, Visit visit) {
        int first = 0, end = m_tile.ranks;
        if constexpr (kMoving) m_where.find_ranks(times, lane, first, end);
        RankPaths paths;
        for (; first < end; first += lane_count()) {
            const M touching = hn::And(find(first, paths),
                                       hn::FirstN(kTag, static_cast<std::size_t>(end - first)));
            for_each_lane(touching, [&](int k) HWY_ATTR {
                m_windows.visit<kMoving, kLens>(
                    paths, k, first + k,
                    [&](const Samples& at, V slots, V x, V y) HWY_ATTR
                    __attribute__((always_inline)) { visit(paths, k, at, slots, x, y); });
            });
        }
    }

    /// Calls visit(samples, slots, x, y) for the samples of a patch's windows; x, y: from where the
    /// patch is then.
    template <bool kMoving, Lens kLens, class Visit>
    HWY_INLINE void visit_together(Visit visit) {
        const bool cull = m_patch.nearest < m_tile.nearest_of_ranks;
        visit_windows<kMoving, kLens>(
            m_patch.times, 0,
            [&](int first, RankPaths& paths) HWY_ATTR {
                return m_paths.follow<kMoving, kLens, RankPathFinder::kAllSquares>(
                    m_patch.paths, 0, m_target.segment, first, cull, paths);
            },
            [&](const RankPaths&, int, const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) { visit(at, slots, x, y); });
    }

    /// Samples of the segment at hand, with its ends: ranks may be longer than it.
    template <bool kMoving>
    HWY_INLINE M in_segment(const Samples& at, M samples) const {
        if (!kMoving || m_grid.segments == 1) return samples;
        const V local = at.t * set(static_cast<float>(m_grid.segments)) -
                        set(static_cast<float>(m_target.segment));
        return hn::And(samples, hn::And(hn::Ge(local, set(0.0f)), hn::Le(local, set(1.0f))));
    }

    /// The samples of the mask wait for the micropolygon in their lane (NearSamples::add).
    template <bool kMoving, Lens kLens>
    HWY_INLINE void queue(M mask, const Samples& at, V slots, hn::Vec<IntTag> index,
                          hn::Vec<IntTag> corner) {
        m_near.add<kMoving, kLens>(mask, at, slots, index, corner,
                                   static_cast<float>(m_target.segment));
        if (HWY_UNLIKELY(m_near.full())) test_near<kMoving, kLens>();
    }

    template <bool kMoving, Lens kLens>
    void visit_patch(const Patch& patch) {
        const PatchFrame& frame = m_patch.frame;
        const V n_u = set(static_cast<float>(patch.n_u)), n_v = set(static_cast<float>(patch.n_v));
        const V row = set(static_cast<float>(m_grid.n_u));
        const V rise = set(static_cast<float>(m_grid.up));
        const auto index = hn::Set(kIntTag, patch.j * m_grid.n_u + patch.i);
        const auto corner =
            hn::Set(kIntTag, m_target.segment * m_grid.vertices + patch.j * m_grid.up + patch.i);
        const int most_u = frame.u.most_near(), most_v = frame.v.most_near();
        visit_together<kMoving, kLens>([&](const Samples& at, V slots, V x,
                                           V y) HWY_ATTR __attribute__((always_inline)) {
            const V zero = set(0.0f);
            const V u = set(frame.u.x) * x + set(frame.u.y) * y + set(frame.u.origin);
            const V v = set(frame.v.x) * x + set(frame.v.y) * y + set(frame.v.origin);
            const V u_lo = u - set(frame.u.reach), u_hi = u + set(frame.u.reach);
            const V v_lo = v - set(frame.v.reach), v_hi = v + set(frame.v.reach);
            // Most samples of a window are beside the patch.
            const M near =
                in_segment<kMoving>(at, hn::And(hn::And(hn::Lt(u_lo, n_u), hn::Ge(u_hi, zero)),
                                                hn::And(hn::Lt(v_lo, n_v), hn::Ge(v_hi, zero))));
            if (hn::AllFalse(kTag, near)) return;
            const V i0 = hn::Floor(u_lo), i1 = hn::Floor(u_hi);
            const V j0 = hn::Floor(v_lo), j1 = hn::Floor(v_hi);
            for (int dj = 0; dj < most_v; ++dj) {
                const V j = j0 + set(static_cast<float>(dj));
                const M in_j =
                    hn::And(hn::And(near, hn::Le(j, j1)), hn::And(hn::Ge(j, zero), hn::Lt(j, n_v)));
                if (hn::AllFalse(kTag, in_j)) continue;
                for (int di = 0; di < most_u; ++di) {
                    const V i = i0 + set(static_cast<float>(di));
                    const M in = hn::And(hn::And(in_j, hn::Le(i, i1)),
                                         hn::And(hn::Ge(i, zero), hn::Lt(i, n_u)));
                    if (!hn::AllFalse(kTag, in))
                        queue<kMoving, kLens>(in, at, slots,
                                              hn::ConvertTo(kIntTag, j * row + i) + index,
                                              hn::ConvertTo(kIntTag, j * rise + i) + corner);
                }
            }
        });
    }

    template <bool kMoving, Lens kLens>
    void visit_flock(const Patch& flock) {
        const int knot = m_target.segment * m_grid.vertices;
        visit_together<kMoving, kLens>([&](const Samples& at, V slots, V x,
                                           V y) HWY_ATTR __attribute__((always_inline)) {
            const FlockSlices::Cells cells = m_slices.cells_of(x, y);
            const M inside = in_segment<kMoving>(at, cells.inside);
            if (hn::AllFalse(kTag, inside)) return;
            alignas(64) int packed[kPacket], index[kPacket] = {}, corner[kPacket] = {};
            std::uint64_t bins[kPacket];
            hn::Store(cells.packed, kIntTag, packed);
            std::uint32_t lanes = 0;
            for_each_lane(inside, [&](int lane) HWY_ATTR {
                bins[lane] = m_slices.bins(packed[lane]);
                lanes |= static_cast<std::uint32_t>(bins[lane] != 0) << lane;
            });
            // Each sample's next micropolygon, until no sample has any.
            while (lanes != 0) {
                const std::uint32_t now = lanes;
                for_each_bit(now, [&](int lane) HWY_ATTR {
                    const int bin = std::countr_zero(bins[lane]);
                    const int j = bin / flock.n_u, i = flock.i + bin - j * flock.n_u;
                    index[lane] = j * m_grid.n_u + i;
                    corner[lane] = knot + j * m_grid.up + i;
                    bins[lane] &= bins[lane] - 1;
                    lanes &= ~(static_cast<std::uint32_t>(bins[lane] == 0) << lane);
                });
                queue<kMoving, kLens>(lanes_of(now), at, slots, hn::Load(kIntTag, index),
                                      hn::Load(kIntTag, corner));
            }
        });
    }

    /// The samples that wait.
    template <bool kMoving, Lens kLens>
    HWY_NOINLINE void test_near() {
        ShapeVector shapes;
        const std::size_t count = m_near.count();
        m_target.kind = m_grid.occurring;
        std::size_t covered = 0;
        for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(lane_count())) {
            const M valid = hn::FirstN(kTag, count - i);
            const auto index = m_near.load_shapes<kMoving>(m_grid, i, valid, shapes);
            const auto ids = hn::BitCast(kIdTag, index) + hn::Set(kIdTag, m_grid.base);
            covered += cover<kMoving, kLens>(shapes, m_near.list(), i, valid, ids, covered);
        }
        m_counts.tests += count;
        m_near.clear();
        m_recorder.record(m_hit, covered);
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
        const M hit = m_test.covers<false, Lens::None>(shape, at, hn::FirstN(kTag, kPacket), hits);
        if (!hn::AllFalse(kTag, hit)) m_recorder.record(hits, hit, first);
    }

    /// What is swept, and what is still in a tile where other things are swept: ranks are bounded a
    /// vector at a time, the samples in each rank's windows of blocks are compared with the
    /// micropolygon's path, and what remains, about twice what is hit, is tested in whole vectors.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void visit_ranks(const Shape& shape, const BlockRanges& swept, int lane) {
        const bool cull = swept.nearest[lane] < m_tile.nearest_of_ranks;
        const bool straight =
            (kMoving || kLens != Lens::None) && (m_tile_paths.straight >> lane & 1u);
        std::size_t found = 0;
        visit_windows<kMoving, kLens>(
            swept, lane,
            [&](int first, RankPaths& paths) HWY_ATTR {
                return straight ? m_paths.follow<kMoving, kLens>(
                                      m_tile_paths, lane, m_target.segment, first, cull, paths)
                                : m_paths.find<kMoving, kLens>(shape, m_target.segment, first, cull,
                                                               paths);
            },
            [&](const RankPaths& paths, int k, const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) {
                const Squeeze near(hn::And(hn::Le(hn::Abs(x), set(paths.x.reach[k])),
                                           hn::Le(hn::Abs(y), set(paths.y.reach[k]))));
                m_listed.add<kMoving, kLens>(near, at, slots, found);
                found += near.count();
                if (HWY_UNLIKELY(found > kMostListed)) {
                    test_listed<kMoving, kLens>(shape, found);
                    found = 0;
                }
            });
        test_listed<kMoving, kLens>(shape, found);
    }

    template <bool kMoving, Lens kLens>
    HWY_INLINE void test_listed(const Shape& shape, std::size_t count) {
        m_counts.tests += count;
        std::size_t covered = 0;
        for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(lane_count()))
            covered += cover<kMoving, kLens>(shape, m_listed, i, hn::FirstN(kTag, count - i),
                                             hn::Set(kIdTag, m_target.id), covered);
        m_recorder.record(m_hit, covered);
    }

    /// A vector of listed samples from i on; appends the hits to the first `covered` ones and
    /// returns how many they are.
    template <bool kMoving, Lens kLens, class S, std::size_t kMost>
    HWY_INLINE std::size_t cover(const S& shape, const SampleList<kMost>& list, std::size_t i,
                                 M valid, hn::Vec<IdTag> ids, std::size_t covered) {
        Hits hits;
        const M hit = m_test.covers<kMoving, kLens>(shape, list.template load<kMoving, kLens>(i),
                                                    valid, hits);
        if (hn::AllFalse(kTag, hit)) return 0;
        const Squeeze squeeze(hit);
        hn::StoreU(squeeze(hits.key), kTag, m_hit.key + covered);
        hn::StoreU(squeeze(hn::LoadU(kTag, list.slot + i)), kTag, m_hit.slot + covered);
        hn::StoreU(squeeze(hn::BitCast(kTag, ids)), kTag, m_hit.id + covered);
        if (m_target.kind & kTransparent) {
            hn::StoreU(squeeze(hits.signed_b1), kTag, m_hit.signed_b1 + covered);
            hn::StoreU(squeeze(hits.b2), kTag, m_hit.b2 + covered);
        }
        return squeeze.count();
    }

    /// Whole vectors and whole patches.
    static constexpr int kStep = std::max(static_cast<int>(hn::MaxLanes(kTag)), Patch::kSide);
    static constexpr int kLeastPatch = 4, kNarrow = 2;
    static constexpr std::size_t kMostListed = 256;
    static constexpr std::size_t kListed = kMostListed + 2 * kPacket;

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
    SimdCounts& m_counts;
    Target m_target;
    TileBounds m_where;
    RankPathFinder m_paths;
    RankWindows m_windows;
    SampleTest m_test;
    HitRecorder m_recorder;
    TilePaths m_tile_paths;
    PatchFinder m_patches;
    FlockFinder m_flocks;
    PatchPath m_patch;
    FlockSlices m_slices;
    NearSamples m_near;            ///< to be tested, of patches and flocks
    const bool m_together;         ///< patches or flocks are looked for
    const bool m_in_flocks;        ///< micropolygons share no vertices, or lie in few rows
    SampleList<kListed> m_listed;  ///< to be tested
    HitList<std::max(kListed, NearSamples::kMost)> m_hit;  ///< that were
};

void hide_grid(const SimdGrid& grid, const SimdTile& tile, FragmentLists& lists,
               SimdCounts& counts) {
    if (grid.occurring == 0) return;
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
