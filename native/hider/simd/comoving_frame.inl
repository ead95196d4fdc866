// SPDX-License-Identifier: GPL-3.0-or-later
// The *co-moving frame* of a grid part: parametric positions over a part whose micropolygons stay
// together while they are over a tile.  Included once a SIMD
// target inside its namespace, after tile_paths.inl.

/// Parameters over a part in the frame that moves with it: micropolygon (i, j) of the part stays
/// within [i - u.reach, i + 1 + u.reach] x [j - v.reach, j + 1 + v.reach] of them.
struct ComovingFrame {
    /// x * dx + y * dy + origin, dx and dy pixels from the part's path.
    struct Axis {
        float x, y, origin, reach;

        /// Micropolygons side by side that a sample may be near to.
        int most_near() const { return reach < 0.5f ? 2 : 3; }
    } u, v;
};

/// How far from a common path, lane 0, something may be on one axis beyond what it is at the ends.
HWY_INLINE V path_slack(V margin, V bend, V lens_rest, const StraightPaths& path,
                        float lens_extent) {
    return margin + bend + lens_rest * set(lens_extent) +
           set((std::fabs(path.place[0]) + std::fabs(path.speed[0])) * 0x1p-20f);
}

/// What is known of a part over a tile.
struct PartPath {
    TilePaths paths;  ///< lane 0
    ComovingFrame frame;
};

class PartFinder {
  public:
    enum class Found { Nowhere, Framed, Loose };

    PartFinder(const SimdGrid& grid, const StratumPathFinder& paths)
        : m_grid(grid), m_paths(paths) {}

    /// Nowhere: not over the tile.  Loose: it bends, turns, grows or is curved too much to have a
    /// frame; `out` is undefined.
    template <bool kMoving, Lens kLens>
    Found find(const GridPart& part, int segment, PartPath& out) {
        load<kMoving>(part, segment);
        V first = set(0.0f), last = first;
        if constexpr (kMoving) {
            TimesOverTile over;
            for_each_vector([&](int k)
                                HWY_ATTR { over.add<kLens>(m_grid, corner(0, k), corner(1, k)); });
            over.reduce();
            if (hn::AllFalse(kTag, over.find(m_grid, segment, first, last))) return Found::Nowhere;
            hn::StoreU(first, kTag, out.paths.t0);
            hn::StoreU(last, kTag, out.paths.t1);
        }
        const SegmentPart<kMoving> during(m_grid, segment, first, last);
        SweptBounds<kMoving, kLens> extents(hn::FirstN(kTag, kPacket));
        for_each_vector([&](int k) HWY_ATTR {
            const Corner<V> begin = corner(0, k);
            Corner<V> delta = begin;
            if constexpr (kMoving) delta = from_to(begin, corner(1, k));
            extents.add(m_grid, begin, delta, during.ends);
            for (int e = 0; e < kEnds<kMoving>; ++e) {
                hn::StoreU(extents.last_x[e], kTag, m_at_x[e] + k);
                hn::StoreU(extents.last_y[e], kTag, m_at_y[e] + k);
            }
        });
        extents.reduce();
        m_paths.store_paths(extents, during, out.paths);
        if (!(out.paths.straight & 1u)) return Found::Loose;
        return find_frame<kMoving, kLens>(part, extents, during, out) ? Found::Framed
                                                                      : Found::Loose;
    }

  private:
    /// On an axis: then a sample is near to three micropolygons at most.
    static constexpr float kMostReach = 1.0f;
    /// Of the samples that each micropolygon is tested against, by those that it covers.
    static constexpr float kMostTests = 4.0f;
    static constexpr int kMost = (GridPart::kSwept + 1) * (GridPart::kSwept + 1) + 2 * kPacket;

    /// The vertices one after another: where they lie, or copied.  Where a vector holds them all
    /// the last one fills it up.
    template <bool kMoving>
    void load(const GridPart& part, int segment) {
        const int wide = part.n_u + 1;
        number(part);
        const bool in_place = part.n_u == m_grid.n_u && m_count >= lane_count();
        const auto place = [&](const float* from, int knot, int coordinate) HWY_ATTR {
            from += static_cast<std::size_t>(segment + knot) * m_grid.vertices +
                    static_cast<std::size_t>(part.j) * m_grid.up + part.i;
            m_at[coordinate][knot] = from;
            if (in_place) return;
            float* const to = m_copies[coordinate][knot];
            for (int j = 0; j <= part.n_v; ++j)
                for (int i = 0; i < wide; i += lane_count())
                    hn::StoreU(hn::LoadU(kTag, from + j * m_grid.up + i), kTag, to + j * wide + i);
            hn::StoreU(set(to[m_count - 1]), kTag, to + m_count);
            m_at[coordinate][knot] = to;
        };
        for (int knot = 0; knot <= (kMoving ? 1 : 0); ++knot) {
            place(m_grid.x, knot, 0);
            place(m_grid.y, knot, 1);
            place(m_grid.w, knot, 2);
            place(m_grid.z, knot, 3);
        }
    }

    /// The parameters of the vertices; most parts are alike.
    void number(const GridPart& part) {
        if (part.n_u == m_n_u && part.n_v == m_n_v) return;
        m_n_u = part.n_u;
        m_n_v = part.n_v;
        const int wide = m_n_u + 1;
        m_count = wide * (m_n_v + 1);
        for (int j = 0; j <= m_n_v; ++j)
            for (int i = 0; i < wide; i += lane_count()) {
                hn::StoreU(hn::Iota(kTag, static_cast<float>(i)), kTag, m_i + j * wide + i);
                hn::StoreU(set(static_cast<float>(j)), kTag, m_j + j * wide + i);
            }
        hn::StoreU(set(static_cast<float>(m_n_u)), kTag, m_i + m_count);
        hn::StoreU(set(static_cast<float>(m_n_v)), kTag, m_j + m_count);
    }

    /// Calls visit(first vertex) for vectors that hold all vertices, some twice.
    template <class Visit>
    HWY_INLINE void for_each_vector(Visit visit) const {
        const int last = std::max(0, m_count - lane_count());
        for (int k = 0; k < m_count; k += lane_count()) visit(std::min(k, last));
    }

    HWY_INLINE Corner<V> corner(int knot, int k) const {
        return {hn::LoadU(kTag, m_at[0][knot] + k), hn::LoadU(kTag, m_at[1][knot] + k),
                hn::LoadU(kTag, m_at[2][knot] + k), hn::LoadU(kTag, m_at[3][knot] + k)};
    }

    /// The affine map that takes the corners of the part, halfway, nearest to their parameters;
    /// `reach` from how far it takes the vertices from theirs.  Between the ends a vertex is no
    /// farther: the map and the chords are linear.
    template <bool kMoving, Lens kLens>
    bool find_frame(const GridPart& part, const SweptBounds<kMoving, kLens>& extents,
                    const SegmentPart<kMoving>& during, PartPath& out) const {
        const int right = part.n_u, above = part.n_v * (part.n_u + 1);
        float right_x = 0, right_y = 0, up_x = 0, up_y = 0;
        for (int e = 0; e < kEnds<kMoving>; ++e) {
            const float *x = m_at_x[e], *y = m_at_y[e];
            right_x += x[right] - x[0] + (x[above + right] - x[above]);
            right_y += y[right] - y[0] + (y[above + right] - y[above]);
            up_x += x[above] - x[0] + (x[above + right] - x[right]);
            up_y += y[above] - y[0] + (y[above + right] - y[right]);
        }
        const float scale = 2.0f * kEnds<kMoving> / (right_x * up_y - right_y * up_x);
        ComovingFrame::Axis& u = out.frame.u;
        ComovingFrame::Axis& v = out.frame.v;
        u.x = up_y * scale * static_cast<float>(part.n_u);
        u.y = -up_x * scale * static_cast<float>(part.n_u);
        v.x = -right_y * scale * static_cast<float>(part.n_v);
        v.y = right_x * scale * static_cast<float>(part.n_v);
        const StraightPaths &path_x = out.paths.x, &path_y = out.paths.y;
        const float end[2] = {hn::GetLane(during.time0), hn::GetLane(during.time1)};
        V u_lo = set(INFINITY), u_hi = set(-INFINITY), v_lo = u_lo, v_hi = u_hi;
        for (int e = 0; e < kEnds<kMoving>; ++e) {
            const V x0 = set(path_x.place[0] + path_x.speed[0] * end[e]);
            const V y0 = set(path_y.place[0] + path_y.speed[0] * end[e]);
            for_each_vector([&](int k) HWY_ATTR {
                const V x = hn::LoadU(kTag, m_at_x[e] + k) - x0;
                const V y = hn::LoadU(kTag, m_at_y[e] + k) - y0;
                const V off_u = hn::LoadU(kTag, m_i + k) - (set(u.x) * x + set(u.y) * y);
                const V off_v = hn::LoadU(kTag, m_j + k) - (set(v.x) * x + set(v.y) * y);
                u_lo = hn::Min(u_lo, off_u);
                u_hi = hn::Max(u_hi, off_u);
                v_lo = hn::Min(v_lo, off_v);
                v_hi = hn::Max(v_hi, off_v);
            });
        }
        const auto lens = StratumPathFinder::shear_of<kLens>(
            extents.lens, set(m_grid.inverse_farthest), set(m_grid.inverse_focus));
        const float slack_x = hn::GetLane(
            path_slack(extents.margin, extents.bend_x, lens.rest, path_x, m_grid.lens_x));
        const float slack_y = hn::GetLane(
            path_slack(extents.margin, extents.bend_y, lens.rest, path_y, m_grid.lens_y));
        const auto bound = [&](V lo, V hi, ComovingFrame::Axis& axis) HWY_ATTR {
            const float least = hn::GetLane(hn::MinOfLanes(kTag, lo));
            const float most = hn::GetLane(hn::MaxOfLanes(kTag, hi));
            axis.origin = 0.5f * (least + most);
            axis.reach = 0.5f * (most - least) + std::fabs(axis.x) * slack_x +
                         std::fabs(axis.y) * slack_y + 0x1p-16f;
        };
        bound(u_lo, u_hi, u);
        bound(v_lo, v_hi, v);
        // False where one is not a number.
        return u.reach < kMostReach && v.reach < kMostReach &&
               (1.0f + 2.0f * u.reach) * (1.0f + 2.0f * v.reach) < kMostTests;
    }

    const SimdGrid& m_grid;
    const StratumPathFinder& m_paths;
    int m_n_u = 0, m_n_v = 0, m_count = 0;     ///< of the part, and vertices
    const float* m_at[4][2];                   ///< x, y, w, z of the vertices at both knots
    float m_copies[4][2][kMost];               ///< of what is not in one run
    float m_at_x[2][kMost], m_at_y[2][kMost];  ///< at the ends, raster
    float m_i[kMost], m_j[kMost];              ///< parameters
};
