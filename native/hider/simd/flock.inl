// SPDX-License-Identifier: GPL-3.0-or-later
// Micropolygons that go together over a tile but have no common lattice, or too narrow a one:
// included once a SIMD target inside its namespace, after patch_frame.inl.

/// Which micropolygons a sample may see, by where it is in the frame that moves with them.  Along
/// each of four directions the frame is cut into slices, and a slice has a bit for every
/// micropolygon whose extent touches it: those of a sample are the bits that its four slices share,
/// so that a micropolygon is bounded by an octagon (discrete oriented polytopes: Klosowski et al.
/// 1998; bits of slices: Lakshman and Stiliadis 1998).
class FlockSlices {
  public:
    static constexpr int kDirections = 4;  ///< x, y, x + y, x - y
    static constexpr int kMost = 64;       ///< micropolygons

    /// Extents of the micropolygons along the directions.
    struct Extents {
        float lo[kDirections][kMost + kPacket], hi[kDirections][kMost + kPacket];
    };

    /// Of the micropolygons of these bits, of which there are some.
    void build(const Extents& extents, std::uint64_t bits) {
        for (int d = 0; d < kDirections; ++d) {
            const float *lo = extents.lo[d], *hi = extents.hi[d];
            float least = INFINITY, most = -INFINITY;
            for_each_bit(bits, [&](int bin) HWY_ATTR {
                least = std::min(least, lo[bin]);
                most = std::max(most, hi[bin]);
            });
            m_origin[d] = least;
            // The last slice holds `most` too, however it rounds.
            m_scale[d] = (kSlices - 0x1p-8f) / std::max(most - least, 1e-6f);
            // Bits of a slice, by what begins and what has ended.
            std::uint64_t* const slices = m_slices[d];
            std::fill_n(slices, kSlices + 1, 0);
            const auto slice = [&](float at) {
                return static_cast<int>((at - m_origin[d]) * m_scale[d]);
            };
            for_each_bit(bits, [&](int bin) HWY_ATTR {
                slices[slice(lo[bin])] ^= std::uint64_t{1} << bin;
                slices[slice(hi[bin]) + 1] ^= std::uint64_t{1} << bin;
            });
            for (int s = 1; s < kSlices; ++s) slices[s] ^= slices[s - 1];
        }
    }

    struct Cells {
        M inside;                ///< of all four directions' slices
        hn::Vec<IntTag> packed;  ///< a byte a direction
    };
    HWY_INLINE Cells cells_of(V x, V y) const {
        const V slice[kDirections] = {place(x, 0), place(y, 1), place(x + y, 2), place(x - y, 3)};
        // A slot without sample has no number anywhere.
        const V least = hn::Min(hn::Min(slice[0], slice[1]), hn::Min(slice[2], slice[3]));
        const V most = hn::Max(hn::Max(slice[0], slice[1]), hn::Max(slice[2], slice[3]));
        Cells cells{hn::And(hn::Ge(least, set(0.0f)), hn::Lt(most, set(kSlices))),
                    hn::ConvertTo(kIntTag, slice[0])};
        for (int d = 1; d < kDirections; ++d)
            cells.packed = hn::Or(hn::ShiftLeft<8>(cells.packed), hn::ConvertTo(kIntTag, slice[d]));
        return cells;
    }
    HWY_INLINE std::uint64_t bins(int packed) const {
        return m_slices[0][packed >> 24] & m_slices[1][packed >> 16 & 0xff] &
               m_slices[2][packed >> 8 & 0xff] & m_slices[3][packed & 0xff];
    }

  private:
    static constexpr int kSlices = 64;

    HWY_INLINE V place(V at, int direction) const {
        return (at - set(m_origin[direction])) * set(m_scale[direction]);
    }

    float m_origin[kDirections], m_scale[kDirections];
    std::uint64_t m_slices[kDirections][kSlices + 1];
};

class FlockFinder {
  public:
    FlockFinder(const SimdGrid& grid, const SimdTile& tile, const TileBounds& where,
                const RankPathFinder& paths)
        : m_grid(grid), m_where(where), m_paths(paths) {
        const float blocks = static_cast<float>(tile.blocks_wide) / kTileSize;
        m_samples = blocks * blocks * static_cast<float>(tile.ranks);
    }

    /// A lens spreads what each would search by itself.  Without one flocks pay only where samples
    /// are few: hiding the spheres of bench/scenes.py takes .21 s for .24 at 8 a pixel, .39 for .34
    /// at 16 and .99 for .62 at 64; through the lens .51 for .92 at 16, 2.4 for 3.0 at 64.
    template <Lens kLens>
    bool pay() const {
        return kLens != Lens::None || m_samples < kFewSamples;
    }

    /// Micropolygon (i, j) of the flock has bit j * n_u + i.  Nowhere: not over the tile.  Loose:
    /// they part, or are few; `path` and `slices` are undefined.
    template <bool kMoving, Lens kLens>
    PatchFinder::Found find(const Patch& flock, int segment, PatchPath& path, FlockSlices& slices) {
        using Found = PatchFinder::Found;
        if (!find_touched<kMoving, kLens>(flock, segment, path.times)) return Found::Nowhere;
        if (std::popcount(m_bits) < kLeast) return Found::Loose;
        const SegmentPart<kMoving> part(m_grid, segment, path.times);
        PathExtents<kMoving, kLens> all(hn::FirstN(kTag, kPacket));
        for (int v = 0; v < m_vectors; ++v) add<kMoving, kLens>(m_vector[v], segment, part, all);
        all.reduce();
        m_paths.store_paths(all, part, path.paths);
        if (!(path.paths.straight & 1u)) return Found::Loose;
        const float key =
            m_grid.range.perspective ? 1.0f / path.paths.z_lo[0] : -path.paths.z_lo[0];
        // The key of a sample may round a few ulp past the nearest corner's.
        path.nearest = key + std::fabs(key) * 0x1p-18f;
        if (!find_extents<kMoving, kLens>(all, part, path.paths)) return Found::Loose;
        slices.build(m_in_frame, m_bits);
        return Found::Framed;
    }

  private:
    static constexpr int kDirections = FlockSlices::kDirections, kMost = FlockSlices::kMost;
    static constexpr int kLeast = 4;
    static constexpr float kFewSamples = 12.0f;
    /// Tests that it is worth to spare a micropolygon a search of its own, and as a part of those
    /// that it needs anyway: as many may be lost because it does not quite go with the others.
    static constexpr float kSpared = 8.0f, kSparedPart = 1.0f / 3;
    static constexpr int kMostVectors = kMost / 4;

    /// Some micropolygons side by side.
    struct RowVector {
        int vertex, bin;
        std::uint32_t touched;  ///< bit i: micropolygon i of them is over the tile
        HWY_INLINE M lanes() const { return lanes_of(touched); }
    };

    /// Those over the tile, and when any is.
    template <bool kMoving, Lens kLens>
    bool find_touched(const Patch& flock, int segment, BlockRanges& times) {
        V t0 = set(INFINITY), t1 = set(-INFINITY);
        m_vectors = 0;
        m_bits = 0;
        for (int j = 0; j < flock.n_v; ++j)
            for (int i = 0; i < flock.n_u; i += lane_count()) {
                const int vertex = (flock.j + j) * m_grid.up + flock.i + i;
                M touched = m_where.find_touched(segment, vertex, flock.n_u - i, times);
                if (hn::AllFalse(kTag, touched)) continue;
                if constexpr (kMoving) {
                    touched = hn::And(touched, m_where.find_times<kLens>(segment, vertex, times));
                    if (hn::AllFalse(kTag, touched)) continue;
                    const V open = hn::LoadU(kTag, times.t0), close = hn::LoadU(kTag, times.t1);
                    t0 = hn::Min(t0, hn::IfThenElse(touched, open, t0));
                    t1 = hn::Max(t1, hn::IfThenElse(touched, close, t1));
                }
                const int bin = j * flock.n_u + i;
                m_vector[m_vectors++] = {vertex, bin, bits_of(touched)};
                m_bits |= std::uint64_t{bits_of(touched)} << bin;
            }
        hn::StoreU(hn::MinOfLanes(kTag, t0), kTag, times.t0);
        hn::StoreU(hn::MaxOfLanes(kTag, t1), kTag, times.t1);
        return m_bits != 0;
    }

    template <bool kMoving, Lens kLens>
    HWY_INLINE void add(const RowVector& row, int segment, const SegmentPart<kMoving>& part,
                        PathExtents<kMoving, kLens>& all) {
        const std::size_t knot = static_cast<std::size_t>(segment) * m_grid.vertices;
        PathExtents<kMoving, kLens> own(hn::FirstN(kTag, kPacket));
        Extent sum, difference;
        for (const int corner : {row.vertex, row.vertex + m_grid.right, row.vertex + m_grid.up,
                                 row.vertex + m_grid.up + m_grid.right}) {
            const std::size_t a = knot + static_cast<std::size_t>(corner);
            const Corner<V> begin = load_corner(m_grid, a);
            Corner<V> delta = begin;
            if constexpr (kMoving)
                delta = from_to(begin,
                                load_corner(m_grid, a + static_cast<std::size_t>(m_grid.vertices)));
            own.add(m_grid, begin, delta, part.ends);
            for (int e = 0; e < (kMoving ? 2 : 1); ++e) {
                sum.add(own.last_x[e] + own.last_y[e], e);
                difference.add(own.last_x[e] - own.last_y[e], e);
            }
        }
        const Extent* const extents[kDirections] = {&own.x, &own.y, &sum, &difference};
        for (int d = 0; d < kDirections; ++d)
            for (int e = 0; e < (kMoving ? 2 : 1); ++e) {
                hn::StoreU(extents[d]->lo[e], kTag, m_extents[e].lo[d] + row.bin);
                hn::StoreU(extents[d]->hi[e], kTag, m_extents[e].hi[d] + row.bin);
            }
        all.merge(own, row.lanes());
    }

    /// Extents in the frame that moves along the path, over all of `part`.  False: too large.
    template <bool kMoving, Lens kLens>
    bool find_extents(const PathExtents<kMoving, kLens>& all, const SegmentPart<kMoving>& part,
                      const TilePaths& paths) {
        const auto lens = RankPathFinder::shear_of<kLens>(all.lens, set(m_grid.inverse_farthest),
                                                          set(m_grid.inverse_focus));
        const V slack_x = path_slack(all.margin, all.bend_x, lens.rest, paths.x, m_grid.lens_x);
        const V slack_y = path_slack(all.margin, all.bend_y, lens.rest, paths.y, m_grid.lens_y);
        const V slack[kDirections] = {slack_x, slack_y, slack_x + slack_y, slack_x + slack_y};
        const V ends[2] = {part.time0, part.time1};
        V at[2][kDirections];
        for (int e = 0; e < (kMoving ? 2 : 1); ++e) {
            const V x = set(paths.x.place[0]) + set(paths.x.speed[0]) * ends[e];
            const V y = set(paths.y.place[0]) + set(paths.y.speed[0]) * ends[e];
            at[e][0] = x;
            at[e][1] = y;
            at[e][2] = x + y;
            at[e][3] = x - y;
        }
        V lost = set(0.0f);  // pixels
        for (int v = 0; v < m_vectors; ++v) {
            const int bin = m_vector[v].bin;
            V size[kDirections], grown[kDirections];
            for (int d = 0; d < kDirections; ++d) {
                V lo = hn::LoadU(kTag, m_extents[0].lo[d] + bin) - at[0][d];
                V hi = hn::LoadU(kTag, m_extents[0].hi[d] + bin) - at[0][d];
                size[d] = hi - lo;
                if constexpr (kMoving) {
                    lo = hn::Min(lo, hn::LoadU(kTag, m_extents[1].lo[d] + bin) - at[1][d]);
                    hi = hn::Max(hi, hn::LoadU(kTag, m_extents[1].hi[d] + bin) - at[1][d]);
                }
                lo = lo - slack[d];
                hi = hi + slack[d];
                grown[d] = hi - lo;
                hn::StoreU(lo, kTag, m_in_frame.lo[d] + bin);
                hn::StoreU(hi, kTag, m_in_frame.hi[d] + bin);
            }
            const V least = size[0] * size[1] * set(1.0f + kSparedPart);
            lost = lost + hn::IfThenElseZero(m_vector[v].lanes(), grown[0] * grown[1] - least);
        }
        // False where it is not a number.
        return hn::GetLane(hn::SumOfLanes(kTag, lost)) * m_samples <
               kSpared * static_cast<float>(std::popcount(m_bits));
    }

    const SimdGrid& m_grid;
    const TileBounds& m_where;
    const RankPathFinder& m_paths;
    float m_samples;           ///< a pixel
    std::uint64_t m_bits = 0;  ///< those over the tile
    RowVector m_vector[kMostVectors];
    int m_vectors = 0;
    FlockSlices::Extents m_extents[2];  ///< at the ends, raster
    FlockSlices::Extents m_in_frame;    ///< over the whole part
};
