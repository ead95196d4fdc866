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
#include "hider/sample_packet.inl"
#include "hider/squeeze.inl"
// Where micropolygons are, and what of them is seen.
#include "hider/path_extents.inl"
#include "hider/shapes.inl"
#include "hider/tile_bounds.inl"
#include "hider/tile_paths.inl"
#include "hider/triangle_pair.inl"
#include "hider/vector_fragments.inl"
// Parts of the kernel.
#include "hider/patch_frame.inl"
#include "hider/rank_windows.inl"
#include "hider/sample_test.inl"
// Those that need them.
#include "hider/flock.inl"
#include "hider/hit_recorder.inl"
#include "hider/patch_bins.inl"

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
          m_in_flocks(grid.right != 1 || grid.n_v <= kNarrow) {}

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
                if (m_together && m_in_flocks) {
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
        if (!m_together) return ~0u;
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

    /// The samples of a patch's windows, sorted by the micropolygons that they may see: find_bins()
    /// adds those of a vector, for_each() tells the bins of each.
    template <bool kMoving, Lens kLens, class FindBins, class ForEach>
    HWY_INLINE void visit_together(const Patch& patch, int pitch, const PatchPath& path,
                                   FindBins find_bins, ForEach for_each) {
        const bool cull = path.nearest < m_tile.nearest_of_ranks;
        const auto test = [&](int number, const PatchBins::Row& row) HWY_ATTR {
            const int bin = number * PatchBins::kRow;
            test_row<kMoving, kLens>(patch.i + bin % pitch, patch.j + bin / pitch, row);
        };
        visit_windows<kMoving, kLens>(
            path.times, 0,
            [&](int first, RankPaths& paths) HWY_ATTR {
                return m_paths.follow<kMoving, kLens, RankPathFinder::kAllSquares>(
                    path.paths, 0, m_target.segment, first, cull, paths);
            },
            [&](const RankPaths&, int, const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) {
                find_bins(at, slots, x, y);
                if (HWY_UNLIKELY(m_bins.full())) m_bins.distribute<kMoving, kLens>(for_each, test);
            });
        m_bins.distribute<kMoving, kLens>(for_each, test);
        m_bins.empty_all(test);
    }

    template <bool kMoving, Lens kLens>
    void visit_patch(const Patch& patch) {
        const PatchFrame& frame = m_patch.frame;
        const V n_u = set(static_cast<float>(patch.n_u)), n_v = set(static_cast<float>(patch.n_v));
        visit_together<kMoving, kLens>(
            patch, Patch::kSide, m_patch,
            [&](const Samples& at, V slots, V x, V y) HWY_ATTR __attribute__((always_inline)) {
                const V zero = set(0.0f);
                const V u = set(frame.u.x) * x + set(frame.u.y) * y + set(frame.u.origin);
                const V v = set(frame.v.x) * x + set(frame.v.y) * y + set(frame.v.origin);
                const V i0 = hn::Floor(u - set(frame.u.reach));
                const V i1 = hn::Floor(u + set(frame.u.reach));
                const V j0 = hn::Floor(v - set(frame.v.reach));
                const V j1 = hn::Floor(v + set(frame.v.reach));
                const M in_i0 = hn::And(hn::Ge(i0, zero), hn::Lt(i0, n_u));
                const M in_j0 = hn::And(hn::Ge(j0, zero), hn::Lt(j0, n_v));
                const M in_i1 = hn::And(hn::Gt(i1, i0), hn::And(hn::Ge(i1, zero), hn::Lt(i1, n_u)));
                const M in_j1 = hn::And(hn::Gt(j1, j0), hn::And(hn::Ge(j1, zero), hn::Lt(j1, n_v)));
                const auto add = [&](M mask, V i, V j) HWY_ATTR __attribute__((always_inline)) {
                    if (hn::AllFalse(kTag, mask)) return;
                    const V bin = i + j * set(static_cast<float>(Patch::kSide));
                    m_bins.add<kMoving, kLens>(mask, at, slots, hn::ConvertTo(kIntTag, bin));
                };
                add(hn::And(in_i0, in_j0), i0, j0);
                add(hn::And(in_i1, in_j0), i1, j0);
                add(hn::And(in_i0, in_j1), i0, j1);
                add(hn::And(in_i1, in_j1), i1, j1);
            },
            [](int bin, auto visit) HWY_ATTR { visit(bin); });
    }

    static_assert(PatchBins::kRows * PatchBins::kRow == FlockSlices::kMost);
    template <bool kMoving, Lens kLens>
    void visit_flock(const Patch& flock) {
        visit_together<kMoving, kLens>(
            flock, FlockFinder::pitch(flock), m_patch,
            [&](const Samples& at, V slots, V x, V y) HWY_ATTR __attribute__((always_inline)) {
                const FlockSlices::Cells cells = m_slices.cells_of(x, y);
                if (!hn::AllFalse(kTag, cells.inside))
                    m_bins.add<kMoving, kLens>(cells.inside, at, slots, cells.packed);
            },
            [&](int cells, auto visit) HWY_ATTR {
                for (std::uint64_t bins = m_slices.bins(cells); bins != 0; bins &= bins - 1)
                    visit(std::countr_zero(bins));
            });
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

    /// The samples of micropolygons (i, j) and its neighbours on the right.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void test_row(int i, int j, const PatchBins::Row& row) {
        constexpr int kRow = PatchBins::kRow;
        ShapeRow shapes;
        const int first = j * m_grid.n_u + i;
        m_target.kind = 0;
        m_target.id = m_grid.base + static_cast<SurfaceId>(first);
        for (int k = 0; k < kRow; ++k) {
            shapes.kind[k] = i + k < m_grid.n_u ? m_grid.classes[first + k] : 0;
            m_target.kind |= shapes.kind[k];
            m_counts.tests += shapes.kind[k] == 0 ? 0 : row.count[k];
        }
        if (m_target.kind == 0) return;
        shapes.load<kMoving>(m_grid, m_target.segment, j * m_grid.up + i);
        const auto lanes = hn::Iota(kIdTag, 0);
        const auto ids = hn::Set(kIdTag, m_target.id) + hn::And(lanes, hn::Set(kIdTag, kRow - 1));
        const auto counts = hn::LoadDup128(kIntTag, row.count);
        const int most = *std::max_element(row.count, row.count + kRow);
        std::size_t covered = 0;
        for (int n = 0; n < most; n += lane_count() / kRow) {
            const auto number =
                hn::BitCast(kIntTag, hn::ShiftRight<2>(lanes)) + hn::Set(kIntTag, n);
            covered +=
                cover<kMoving, kLens>(shapes, row.list, static_cast<std::size_t>(n) * kRow,
                                      hn::RebindMask(kTag, hn::Lt(number, counts)), ids, covered);
        }
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
    PatchBins m_bins;
    const bool m_together;         ///< patches or flocks are looked for
    const bool m_in_flocks;        ///< micropolygons share no vertices, or lie in few rows
    SampleList<kListed> m_listed;  ///< to be tested
    HitList<kListed> m_hit;        ///< that were
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
