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
          m_in_flocks(grid.n_v <= GridPart::kNarrow) {
        const double blocks = static_cast<double>(tile.blocks_wide) / kTileSize;
        const double samples = GridPart::kSwept * GridPart::kSwept * blocks * blocks * tile.ranks;
        while (m_most_segments < *grid.together &&
               samples * m_most_segments < kFewSamples * grid.segments)
            m_most_segments *= 2;
    }

    template <Lens kLens>
    void run() {
        m_grid.segments > 0 ? run<true, kLens>() : run<false, kLens>();
    }

  private:
    template <bool kMoving, Lens kLens>
    void run() {
        for (const GridPart& part : m_grid.parts) {
            m_patch.nearest = part.nearest;
            if constexpr (kMoving || kLens != Lens::None) {
                if (m_together && (!m_in_flocks || m_flocks.pay<kLens>())) {
                    look_together<kMoving, kLens>(part.patch, part.segments);
                    continue;
                }
            }
            look_apart<kMoving, kLens>(part.patch, part.segments);
        }
        if constexpr (kMoving || kLens != Lens::None) test_near<kMoving, kLens>();
    }

    /// As many segments at a time as the part's way is straight enough for; one by one where it is
    /// not even during one.
    template <bool kMoving, Lens kLens>
    void look_together(const Patch& part, Segments segments) {
        const int end = segments.first + segments.count;
        for (Segments now{segments.first, 0}; now.first < end; now.first += now.count) {
            now.count = std::min(m_most_segments, end - now.first);
            const Found found = find_together<kMoving, kLens>(part, now);
            if (found != Found::Loose) continue;
            if (now.count == 1) {
                look_apart<kMoving, kLens>(part, now);
            } else {
                m_most_segments = now.count / 2;
                // Patches of a grid turn alike in all tiles, flocks are of unlike sizes.
                if (!m_in_flocks) *m_grid.together = m_most_segments;
                now.count = 0;
            }
        }
    }

    using Found = PatchFinder::Found;
    template <bool kMoving, Lens kLens>
    Found find_together(const Patch& part, Segments segments) {
        Found found;
        if (m_in_flocks) {
            found = m_flocks.find<kMoving, kLens>(part, segments, m_patch, m_slices);
            if (found == Found::Framed) visit_flock<kMoving, kLens>(part, segments);
        } else {
            found = m_patches.find<kMoving, kLens>(part, segments, m_patch);
            if (found == Found::Framed) visit_patch<kMoving, kLens>(part, segments);
        }
        return found;
    }

    template <bool kMoving, Lens kLens>
    void look_apart(const Patch& part, Segments segments) {
        for (int k = 0; k < segments.count; ++k) {
            m_target.segment = segments.first + k;
            for (int j = 0; j < part.n_v; ++j)
                for (int i = 0; i < part.n_u; i += lane_count())
                    visit_row<kMoving, kLens>(part.i + i, part.j + j, part.n_u - i);
        }
    }

    /// A vector of `count` micropolygons at most from (i, j) on.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void visit_row(int i, int j, int count) {
        BlockRanges ranges;
        const int segment = m_target.segment, first = j * m_grid.up + i;
        M touching = m_where.find_touched(segment, first, count, ranges);
        if (kMoving && !hn::AllFalse(kTag, touching))
            touching = hn::And(touching, m_where.find_times<kLens>(segment, first, ranges));
        if ((kMoving || kLens != Lens::None) && !hn::AllFalse(kTag, touching))
            m_paths.find_paths<kMoving, kLens>(segment, first, ranges, m_tile_paths);
        for_each_lane(touching, [&](int lane) HWY_ATTR {
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
    HWY_INLINE void visit_together(Segments segments, Visit visit) {
        const bool cull = m_patch.nearest < m_tile.nearest_of_ranks;
        visit_windows<kMoving, kLens>(
            m_patch.times, 0,
            [&](int first, RankPaths& paths) HWY_ATTR {
                return m_paths.follow<kMoving, kLens, RankPathFinder::kAllSquares>(
                    m_patch.paths, 0, segments, first, cull, paths);
            },
            [&](const RankPaths&, int, const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) { visit(at, slots, x, y); });
    }

    /// Which of the samples look during the segments, and the segment of each: ranks may be longer.
    template <bool kMoving>
    HWY_INLINE M in_segments(const Samples& at, M samples, Segments segments, V& segment) const {
        segment = set(static_cast<float>(segments.first));
        if (!kMoving || m_grid.segments == 1) return samples;
        const V all = set(static_cast<float>(m_grid.segments));
        const V end = segment + set(static_cast<float>(segments.count));
        const V own = hn::Min(hn::Floor(at.t * all), all - set(1.0f));
        const M in = hn::And(hn::Ge(own, segment), hn::Lt(own, end));
        segment = own;
        return hn::And(samples, in);
    }

    /// The samples of the mask wait for the micropolygon in their lane (NearSamples::add): `corner`
    /// is its vertex at the first knot.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void queue(M mask, const Samples& at, V slots, hn::Vec<IntTag> index,
                          hn::Vec<IntTag> corner, V segment) {
        if constexpr (kMoving)
            corner = corner + hn::ConvertTo(kIntTag, segment) * hn::Set(kIntTag, m_grid.vertices);
        m_near.add<kMoving, kLens>(mask, at, slots, index, corner, segment);
        if (HWY_UNLIKELY(m_near.full())) test_near<kMoving, kLens>();
    }

    template <bool kMoving, Lens kLens>
    void visit_patch(const Patch& patch, Segments segments) {
        const PatchFrame& frame = m_patch.frame;
        const V n_u = set(static_cast<float>(patch.n_u)), n_v = set(static_cast<float>(patch.n_v));
        const V row = set(static_cast<float>(m_grid.n_u));
        const V rise = set(static_cast<float>(m_grid.up));
        const auto index = hn::Set(kIntTag, patch.j * m_grid.n_u + patch.i);
        const auto corner = hn::Set(kIntTag, patch.j * m_grid.up + patch.i);
        const int most_u = frame.u.most_near(), most_v = frame.v.most_near();
        visit_together<kMoving, kLens>(
            segments, [&](const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) {
                const V zero = set(0.0f);
                const V u = set(frame.u.x) * x + set(frame.u.y) * y + set(frame.u.origin);
                const V v = set(frame.v.x) * x + set(frame.v.y) * y + set(frame.v.origin);
                const V u_lo = u - set(frame.u.reach), u_hi = u + set(frame.u.reach);
                const V v_lo = v - set(frame.v.reach), v_hi = v + set(frame.v.reach);
                // Most samples of a window are beside the patch.
                V segment;
                const M near =
                    in_segments<kMoving>(at,
                                         hn::And(hn::And(hn::Lt(u_lo, n_u), hn::Ge(u_hi, zero)),
                                                 hn::And(hn::Lt(v_lo, n_v), hn::Ge(v_hi, zero))),
                                         segments, segment);
                if (hn::AllFalse(kTag, near)) return;
                const V i0 = hn::Floor(u_lo), i1 = hn::Floor(u_hi);
                const V j0 = hn::Floor(v_lo), j1 = hn::Floor(v_hi);
                for (int dj = 0; dj < most_v; ++dj) {
                    const V j = j0 + set(static_cast<float>(dj));
                    const M in_j = hn::And(hn::And(near, hn::Le(j, j1)),
                                           hn::And(hn::Ge(j, zero), hn::Lt(j, n_v)));
                    if (hn::AllFalse(kTag, in_j)) continue;
                    for (int di = 0; di < most_u; ++di) {
                        const V i = i0 + set(static_cast<float>(di));
                        const M in = hn::And(hn::And(in_j, hn::Le(i, i1)),
                                             hn::And(hn::Ge(i, zero), hn::Lt(i, n_u)));
                        if (!hn::AllFalse(kTag, in))
                            queue<kMoving, kLens>(
                                in, at, slots, hn::ConvertTo(kIntTag, j * row + i) + index,
                                hn::ConvertTo(kIntTag, j * rise + i) + corner, segment);
                    }
                }
            });
    }

    template <bool kMoving, Lens kLens>
    void visit_flock(const Patch& flock, Segments segments) {
        static_assert(GridPart::kNarrow == 2);
        const auto begin = hn::Set(kIntTag, flock.i);
        const auto last = hn::Set(kIntTag, flock.n_u - 1);
        const auto next_row = hn::Set(kIntTag, m_grid.n_u - flock.n_u);
        const auto rise = hn::Set(kIntTag, m_grid.up - flock.n_u);
        visit_together<kMoving, kLens>(
            segments, [&](const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) {
                const FlockSlices::Cells cells = m_slices.cells_of(x, y);
                V segment;
                const M inside = in_segments<kMoving>(at, cells.inside, segments, segment);
                if (hn::AllFalse(kTag, inside)) return;
                m_slices.for_each_bin(
                    cells, inside,
                    [&](M some, hn::Vec<IntTag> bin) HWY_ATTR __attribute__((always_inline)) {
                        const auto above = hn::Gt(bin, last);
                        queue<kMoving, kLens>(
                            some, at, slots, bin + begin + hn::IfThenElseZero(above, next_row),
                            bin + begin + hn::IfThenElseZero(above, rise), segment);
                    });
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
                                      m_tile_paths, lane, {m_target.segment, 1}, first, cull, paths)
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

    static constexpr int kLeastPatch = 4;
    /// A frame is worth as many samples of a patch of pixels: 16 segments at 8 samples a pixel
    /// leave 32 for each.
    static constexpr double kFewSamples = 128.0;
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
    int m_most_segments = 1;       ///< that patches and flocks are looked at together during
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
