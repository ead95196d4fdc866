// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/simd_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "hider/micropolygon_class.h"
#include "hider/samples/sample_order.h"
#include "hider/simd/stratum_bounds.h"

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
#include "hider/simd/compact.inl"
#include "hider/simd/sample_packet.inl"
// Where micropolygons are, and what of them is seen.
#include "hider/simd/shapes.inl"
#include "hider/simd/tile_bounds.inl"
// Those that need it.
#include "hider/simd/swept_bounds.inl"
#include "hider/simd/tile_paths.inl"
#include "hider/simd/triangle_pair.inl"
#include "hider/vector_fragments.inl"
// Parts of the kernel.
#include "hider/simd/comoving_frame.inl"
#include "hider/simd/sample_test.inl"
#include "hider/simd/stratum_windows.inl"
// Those that need them.
#include "hider/simd/candidate_samples.inl"
#include "hider/simd/cluster.inl"
#include "hider/simd/hit_recorder.inl"

class Kernel {
  public:
    Kernel(const SimdGrid& grid, const SimdTile& tile, FragmentLists& lists, SimdCounts& counts)
        : m_grid(grid),
          m_tile(tile),
          m_counts(counts),
          m_paths(grid, tile),
          m_windows(tile),
          m_test(grid, m_target),
          m_recorder(grid, tile, m_target, lists, counts),
          m_parts(grid, m_paths),
          m_clusters(grid, tile, m_paths),
          m_together(grid.finite && grid.n_u * grid.n_v >= kLeastPart),
          m_in_clusters(grid.n_v <= GridPart::kNarrow) {}

    template <Lens kLens>
    void run() {
        m_grid.segments > 0 ? run<true, kLens>() : run<false, kLens>();
    }

  private:
    template <bool kMoving, Lens kLens>
    void run() {
        for (const PartSegment& at : m_grid.parts) {
            if constexpr (kMoving || kLens != Lens::None) {
                if (m_together && (!m_in_clusters || m_clusters.pay<kLens>()) &&
                    look_together<kMoving, kLens>(at.part, at.segment))
                    continue;
            }
            look_apart<kMoving, kLens>(at.part, at.segment);
        }
        if constexpr (kMoving || kLens != Lens::None) test_candidates<kMoving, kLens>();
    }

    /// False: what is in the part goes too differently.
    template <bool kMoving, Lens kLens>
    bool look_together(const GridPart& part, int segment) {
        using Found = PartFinder::Found;
        Found found;
        if (m_in_clusters) {
            found = m_clusters.find<kMoving, kLens>(part, segment, m_part, m_slices);
            if (found == Found::Framed) visit_cluster<kMoving, kLens>(part, segment);
        } else {
            found = m_parts.find<kMoving, kLens>(part, segment, m_part);
            if (found == Found::Framed) visit_part<kMoving, kLens>(part, segment);
        }
        return found != Found::Loose;
    }

    template <bool kMoving, Lens kLens>
    void look_apart(const GridPart& part, int segment) {
        m_target.segment = segment;
        for (int j = 0; j < part.n_v; ++j)
            for (int i = 0; i < part.n_u; i += lane_count())
                visit_row<kMoving, kLens>(part.i + i, part.j + j, part.n_u - i);
    }

    /// A vector of `count` micropolygons at most from (i, j) on.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void visit_row(int i, int j, int count) {
        const int segment = m_target.segment, first = j * m_grid.up + i;
        const M over = m_paths.find_paths<kMoving, kLens>(
            segment, first, hn::FirstN(kTag, static_cast<std::size_t>(count)), m_tile_paths);
        for_each_lane(over, [&](int lane) HWY_ATTR {
            if (!aim_at(i + lane, j)) return;
            const Shape shape = load_shape(m_grid, segment, first + lane, m_target.kind);
            if (kMoving || kLens != Lens::None || m_tile.stratified)
                visit_strata<kMoving, kLens>(shape, lane);
            else
                visit_packets(shape, lane);
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
    /// the samples of the windows of all strata that the times of what is over the tile, `lane` of
    /// `over`, and find(first stratum, paths) leave; the path is lane k of `paths`.  Strata are
    /// bounded a vector at a time.
    template <bool kMoving, Lens kLens, class Find, class Visit>
    HWY_INLINE void visit_windows(const TilePaths& over, int lane, Find find, Visit visit) {
        int first = 0, end = m_tile.strata;
        if constexpr (kMoving) m_paths.find_strata(over, lane, first, end);
        StratumPaths paths;
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

    /// Calls visit(samples, slots, x, y) for the samples of a part's windows; x, y: from where the
    /// part is then.
    template <bool kMoving, Lens kLens, class Visit>
    HWY_INLINE void visit_together(int segment, Visit visit) {
        const TilePaths& over = m_part.paths;
        const bool cull = over.nearest[0] < m_tile.nearest_of_strata;
        visit_windows<kMoving, kLens>(
            over, 0,
            [&](int first, StratumPaths& paths) HWY_ATTR {
                return m_paths.follow<kMoving, kLens, StratumPathFinder::kAllSquares>(
                    over, 0, segment, first, cull, paths);
            },
            [&](const StratumPaths&, int, const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) { visit(at, slots, x, y); });
    }

    /// Which of the samples look during the segment: strata may be longer.
    template <bool kMoving>
    HWY_INLINE M in_segment(const Samples& at, M samples, int segment) const {
        if (!kMoving || m_grid.segments == 1) return samples;
        const V all = set(static_cast<float>(m_grid.segments));
        const V own = hn::Min(hn::Floor(at.t * all), all - set(1.0f));
        return hn::And(samples, hn::Eq(own, set(static_cast<float>(segment))));
    }

    /// The samples of the mask wait for the micropolygon in their lane (CandidateSamples::add):
    /// `corner` is its vertex at the segment's begin.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void queue(M mask, const Samples& at, V slots, hn::Vec<IntTag> index,
                          hn::Vec<IntTag> corner, int segment) {
        m_candidates.add<kMoving, kLens>(mask, at, slots, index, corner,
                                         set(static_cast<float>(segment)));
        if (HWY_UNLIKELY(m_candidates.full())) test_candidates<kMoving, kLens>();
    }

    template <bool kMoving, Lens kLens>
    void visit_part(const GridPart& part, int segment) {
        const ComovingFrame& frame = m_part.frame;
        const V n_u = set(static_cast<float>(part.n_u)), n_v = set(static_cast<float>(part.n_v));
        const V row = set(static_cast<float>(m_grid.n_u));
        const V rise = set(static_cast<float>(m_grid.up));
        const auto index = hn::Set(kIntTag, part.j * m_grid.n_u + part.i);
        const auto corner =
            hn::Set(kIntTag, segment * m_grid.vertices + part.j * m_grid.up + part.i);
        const int most_u = frame.u.most_near(), most_v = frame.v.most_near();
        visit_together<kMoving, kLens>(
            segment, [&](const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) {
                const V zero = set(0.0f);
                const V u = set(frame.u.x) * x + set(frame.u.y) * y + set(frame.u.origin);
                const V v = set(frame.v.x) * x + set(frame.v.y) * y + set(frame.v.origin);
                const V u_lo = u - set(frame.u.reach), u_hi = u + set(frame.u.reach);
                const V v_lo = v - set(frame.v.reach), v_hi = v + set(frame.v.reach);
                // Most samples of a window are beside the part.
                const M near =
                    in_segment<kMoving>(at,
                                        hn::And(hn::And(hn::Lt(u_lo, n_u), hn::Ge(u_hi, zero)),
                                                hn::And(hn::Lt(v_lo, n_v), hn::Ge(v_hi, zero))),
                                        segment);
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
    void visit_cluster(const GridPart& cluster, int segment) {
        static_assert(GridPart::kNarrow == 2);
        const auto begin = hn::Set(kIntTag, cluster.i);
        const auto corner = hn::Set(kIntTag, segment * m_grid.vertices + cluster.i);
        const auto last = hn::Set(kIntTag, cluster.n_u - 1);
        const auto next_row = hn::Set(kIntTag, m_grid.n_u - cluster.n_u);
        const auto rise = hn::Set(kIntTag, m_grid.up - cluster.n_u);
        visit_together<kMoving, kLens>(
            segment, [&](const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) {
                const ClusterSlices::Cells cells = m_slices.cells_of(x, y);
                const M inside = in_segment<kMoving>(at, cells.inside, segment);
                if (hn::AllFalse(kTag, inside)) return;
                m_slices.for_each_bin(
                    cells, inside,
                    [&](M some, hn::Vec<IntTag> bin) HWY_ATTR __attribute__((always_inline)) {
                        const auto above = hn::Gt(bin, last);
                        queue<kMoving, kLens>(
                            some, at, slots, bin + begin + hn::IfThenElseZero(above, next_row),
                            bin + corner + hn::IfThenElseZero(above, rise), segment);
                    });
            });
    }

    /// The samples that wait.
    template <bool kMoving, Lens kLens>
    HWY_NOINLINE void test_candidates() {
        ShapeVector shapes;
        const std::size_t count = m_candidates.count();
        m_target.kind = m_grid.occurring;
        std::size_t covered = 0;
        for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(lane_count())) {
            const M valid = hn::FirstN(kTag, count - i);
            const auto index = m_candidates.load_shapes<kMoving>(m_grid, i, valid, shapes);
            const auto ids = hn::BitCast(kIdTag, index) + hn::Set(kIdTag, m_grid.base);
            covered += cover<kMoving, kLens>(shapes, m_candidates.list(), i, valid, ids, covered);
        }
        m_counts.tests += count;
        m_candidates.clear();
        m_recorder.record(m_hit, covered);
    }

    /// What is still is tested against all packets of its blocks.
    HWY_INLINE void visit_packets(const Shape& shape, int lane) {
        const TilePaths& over = m_tile_paths;
        const float nearest = over.nearest[lane];
        const int packets = m_tile.strata / kPacket;
        const int x0 = over.x0[lane], x1 = over.x1[lane], y1 = over.y1[lane];
        for (int by = over.y0[lane]; by <= y1; ++by)
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

    /// What is swept, and what is still in a tile where other things are swept: strata are bounded
    /// a vector at a time, the samples in each stratum's windows of blocks are compared with the
    /// micropolygon's path, and what remains, about twice what is hit, is tested in whole vectors.
    template <bool kMoving, Lens kLens>
    HWY_INLINE void visit_strata(const Shape& shape, int lane) {
        const bool cull = m_tile_paths.nearest[lane] < m_tile.nearest_of_strata;
        const bool straight = m_tile_paths.straight >> lane & 1u;
        std::size_t found = 0;
        visit_windows<kMoving, kLens>(
            m_tile_paths, lane,
            [&](int first, StratumPaths& paths) HWY_ATTR {
                return straight ? m_paths.follow<kMoving, kLens>(
                                      m_tile_paths, lane, m_target.segment, first, cull, paths)
                                : m_paths.find<kMoving, kLens>(shape, m_target.segment, first, cull,
                                                               paths);
            },
            [&](const StratumPaths& paths, int k, const Samples& at, V slots, V x, V y) HWY_ATTR
            __attribute__((always_inline)) {
                const Compact near(hn::And(hn::Le(hn::Abs(x), set(paths.x.reach[k])),
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
        const Compact compact(hit);
        hn::StoreU(compact(hits.key), kTag, m_hit.key + covered);
        hn::StoreU(compact(hn::LoadU(kTag, list.slot + i)), kTag, m_hit.slot + covered);
        hn::StoreU(compact(hn::BitCast(kTag, ids)), kTag, m_hit.id + covered);
        if (m_target.kind & kTransparent) {
            hn::StoreU(compact(hits.signed_b1), kTag, m_hit.signed_b1 + covered);
            hn::StoreU(compact(hits.b2), kTag, m_hit.b2 + covered);
        }
        return compact.count();
    }

    static constexpr int kLeastPart = 4;
    static constexpr std::size_t kMostListed = 256;
    static constexpr std::size_t kListed = kMostListed + 2 * kPacket;

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
    SimdCounts& m_counts;
    Target m_target;
    StratumPathFinder m_paths;
    StratumWindows m_windows;
    SampleTest m_test;
    HitRecorder m_recorder;
    TilePaths m_tile_paths;
    PartFinder m_parts;
    ClusterFinder m_clusters;
    PartPath m_part;
    ClusterSlices m_slices;
    CandidateSamples m_candidates;  ///< to be tested, of parts and clusters
    const bool m_together;          ///< parts or clusters are looked for
    const bool m_in_clusters;       ///< micropolygons share no vertices, or lie in few rows
    SampleList<kListed> m_listed;   ///< to be tested
    HitList<std::max(kListed, CandidateSamples::kMost)> m_hit;  ///< that were
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
