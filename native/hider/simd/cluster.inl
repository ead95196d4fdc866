// SPDX-License-Identifier: GPL-3.0-or-later
// A *cluster*: up to 64 micropolygons that are tested against one list of candidate samples,
// because they go together over a tile but have no common lattice, or too narrow a one.  Included
// once a SIMD target inside its namespace, after comoving_frame.inl.

/// Which micropolygons a sample may see, by where it is in the frame that moves with them.  Along
/// each of four directions the frame is cut into slices, and a slice has a bit for every
/// micropolygon whose extent touches it: those of a sample are the bits that its four slices share,
/// so that a micropolygon is bounded by an octagon (discrete oriented polytopes: Klosowski et al.
/// 1998; bits of slices: Lakshman and Stiliadis 1998).
class ClusterSlices {
  public:
    static constexpr int kDirections = 4;                ///< x, y, x + y, x - y
    static constexpr int kMost = GridPart::kMostInRows;  ///< micropolygons
    using Bits = hn::Vec<IdTag>;

    /// Extents of the micropolygons along the directions.
    struct Extents {
        float lo[kDirections][kMost + kPacket], hi[kDirections][kMost + kPacket];
    };

    /// Of the micropolygons of these bits, of which there are some.
    void build(const Extents& extents, std::uint64_t bits) {
        m_first = std::countr_zero(bits);
        m_wide = (bits >> m_first) >> 32 != 0;
        for (int d = 0; d < kDirections; ++d) {
            const float *lo = extents.lo[d], *hi = extents.hi[d];
            V least = set(INFINITY), most = set(-INFINITY);
            for (int bin = 0; bin < kMost; bin += lane_count()) {
                const M some = lanes_of(static_cast<std::uint32_t>(bits >> bin));
                least = hn::Min(least, hn::IfThenElse(some, hn::LoadU(kTag, lo + bin), least));
                most = hn::Max(most, hn::IfThenElse(some, hn::LoadU(kTag, hi + bin), most));
            }
            const float begin = hn::GetLane(hn::MinOfLanes(kTag, least));
            const float length = hn::GetLane(hn::MaxOfLanes(kTag, most)) - begin;
            m_origin[d] = begin;
            // The last slice holds the end too, however it rounds.
            m_scale[d] = (kSlices - 0x1p-8f) / std::max(length, 1e-6f);
            int from[kMost], to[kMost];
            for (int bin = 0; bin < kMost; bin += lane_count()) {
                hn::StoreU(slice(hn::LoadU(kTag, lo + bin), d), kIntTag, from + bin);
                hn::StoreU(slice(hn::LoadU(kTag, hi + bin), d), kIntTag, to + bin);
            }
            // Bits of a slice, by what begins and what has ended.
            std::uint64_t slices[kSlices + 1] = {}, now = 0;
            for_each_bit(bits, [&](int bin) HWY_ATTR {
                const std::uint64_t bit = std::uint64_t{1} << (bin - m_first);
                slices[from[bin]] ^= bit;
                slices[to[bin] + 1] ^= bit;
            });
            for (int s = 0; s < kSlices; ++s) {
                now ^= slices[s];
                m_words[d][0][s] = static_cast<std::uint32_t>(now);
                m_words[d][1][s] = static_cast<std::uint32_t>(now >> 32);
            }
        }
    }

    /// Where samples are along the directions.
    struct Cells {
        V slice[kDirections];
        M inside;  ///< of all four directions' slices
    };
    HWY_INLINE Cells cells_of(V x, V y) const {
        Cells cells{{place(x, 0), place(y, 1), place(x + y, 2), place(x - y, 3)}, {}};
        const V(&at)[kDirections] = cells.slice;
        // A slot without sample has no number anywhere.
        const V least = hn::Min(hn::Min(at[0], at[1]), hn::Min(at[2], at[3]));
        const V most = hn::Max(hn::Max(at[0], at[1]), hn::Max(at[2], at[3]));
        cells.inside = hn::And(hn::Ge(least, set(0.0f)), hn::Lt(most, set(kSlices)));
        return cells;
    }

    /// Calls visit(samples, the bit of a micropolygon for each) until those in the lanes of the
    /// mask have been told all that they may see.
    template <class Visit>
    HWY_INLINE void for_each_bin(const Cells& cells, M inside, Visit visit) const {
        const Bits none = hn::Zero(kIdTag), one = hn::Set(kIdTag, 1);
        const auto in = hn::RebindMask(kIdTag, inside);
        Bits low = hn::IfThenElseZero(in, look_up(cells, 0)), high = none;
        if (m_wide) high = hn::IfThenElseZero(in, look_up(cells, 1));
        const auto first = hn::Set(kIntTag, m_first), later = hn::Set(kIntTag, m_first + 32);
        for (;;) {
            const auto in_low = hn::Ne(low, none);
            const Bits word = hn::IfThenElse(in_low, low, high);
            const M some = hn::RebindMask(kTag, hn::Ne(word, none));
            if (hn::AllFalse(kTag, some)) return;
            const Bits rest = hn::And(word, word - one);
            visit(some, lowest(hn::Xor(word, rest)) +
                            hn::IfThenElse(hn::RebindMask(kIntTag, in_low), first, later));
            low = hn::IfThenElseZero(in_low, rest);
            high = hn::IfThenElse(in_low, high, rest);
        }
    }

  private:
    static constexpr int kSlices = 32;

    HWY_INLINE V place(V at, int direction) const {
        return (at - set(m_origin[direction])) * set(m_scale[direction]);
    }
    HWY_INLINE hn::Vec<IntTag> slice(V at, int direction) const {
        return hn::ConvertTo(kIntTag, place(at, direction));
    }

    /// Which of several bits this one is.
    static HWY_INLINE hn::Vec<IntTag> lowest(Bits bit) {
        // By the exponent; the uppermost bit is a negative number.
        const V value = hn::ConvertTo(kTag, hn::BitCast(kIntTag, bit));
        const auto exponent = hn::ShiftRight<23>(hn::BitCast(kIntTag, hn::Abs(value)));
        return exponent - hn::Set(kIntTag, 127);
    }

    /// Bits that samples inside share, 32 of them.
    HWY_INLINE Bits look_up(const Cells& cells, int word) const {
        Bits shared = hn::Set(kIdTag, ~0u);
        for (int d = 0; d < kDirections; ++d)
            shared = hn::And(shared, read(m_words[d][word], cells.slice[d]));
        return shared;
    }
    /// From registers, all lanes at once: one by one, every other sample was a branch foretold
    /// wrongly.
    static HWY_INLINE Bits read(const std::uint32_t* words, V slice) {
        constexpr int kLanes = hn::MaxLanes(kTag);
        const auto at = hn::ConvertTo(kIntTag, slice);
        const auto within = hn::IndicesFromVec(kIdTag, hn::And(at, hn::Set(kIntTag, kLanes - 1)));
        Bits out = hn::TableLookupLanes(hn::LoadU(kIdTag, words), within);
        for (int first = kLanes; first < kSlices; first += kLanes) {
            const M later = hn::Ge(slice, set(static_cast<float>(first)));
            out =
                hn::IfThenElse(hn::RebindMask(kIdTag, later),
                               hn::TableLookupLanes(hn::LoadU(kIdTag, words + first), within), out);
        }
        return out;
    }

    int m_first = 0;      ///< micropolygon that has the lowest bit
    bool m_wide = false;  ///< some have bits of the second word
    float m_origin[kDirections], m_scale[kDirections];
    alignas(64) std::uint32_t m_words[kDirections][2][kSlices];
};

class ClusterFinder {
  public:
    ClusterFinder(const SimdGrid& grid, const SimdTile& tile, const StratumPathFinder& paths)
        : m_grid(grid), m_paths(paths) {
        const float blocks = static_cast<float>(tile.blocks_wide) / kTileSize;
        m_samples = blocks * blocks * static_cast<float>(tile.strata);
    }

    /// A lens spreads what each would search by itself.  Without one clusters pay only where
    /// samples are few: hiding the spheres of bench/scenes.py takes .21 s for .24 at 8 a pixel, .39
    /// for .34 at 16 and .99 for .62 at 64; through the lens .51 for .92 at 16, 2.4 for 3.0 at 64.
    template <Lens kLens>
    bool pay() const {
        return kLens != Lens::None || m_samples < kFewSamples;
    }

    /// Micropolygon (i, j) of the cluster has bit j * n_u + i.  Nowhere: not over the tile.  Loose:
    /// they part, or are few; `path` and `slices` are undefined.
    template <bool kMoving, Lens kLens>
    PartFinder::Found find(const GridPart& cluster, int segment, PartPath& path,
                           ClusterSlices& slices) {
        using Found = PartFinder::Found;
        V first = set(0.0f), last = first;
        find_vectors<kMoving, kLens>(cluster, segment, first, last);
        if (m_vectors == 0) return Found::Nowhere;
        const SegmentPart<kMoving> during(m_grid, segment, first, last);
        SweptBounds<kMoving, kLens> all(hn::FirstN(kTag, kPacket));
        m_bits = 0;
        for (int v = 0; v < m_vectors; ++v)
            add<kMoving, kLens>(m_vector[v], segment, during, path.paths, all);
        if (m_bits == 0) return Found::Nowhere;
        if (std::popcount(m_bits) < kLeast) return Found::Loose;
        all.reduce();
        m_paths.store_paths(all, during, path.paths);
        hn::StoreU(first, kTag, path.paths.t0);
        hn::StoreU(last, kTag, path.paths.t1);
        if (!(path.paths.straight & 1u)) return Found::Loose;
        if (!find_extents<kMoving, kLens>(all, during, path.paths)) return Found::Loose;
        slices.build(m_in_frame, m_bits);
        return Found::Framed;
    }

  private:
    static constexpr int kDirections = ClusterSlices::kDirections, kMost = ClusterSlices::kMost;
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

    /// Those that are over the tile at some time, and when any is; all of what does not move.
    template <bool kMoving, Lens kLens>
    void find_vectors(const GridPart& cluster, int segment, V& first, V& last) {
        V t0 = set(INFINITY), t1 = set(-INFINITY);
        m_vectors = 0;
        for (int j = 0; j < cluster.n_v; ++j)
            for (int i = 0; i < cluster.n_u; i += lane_count()) {
                const int vertex = (cluster.j + j) * m_grid.up + cluster.i + i;
                M over = hn::FirstN(kTag, static_cast<std::size_t>(cluster.n_u - i));
                if constexpr (kMoving) {
                    V open = t0, close = t1;
                    over = hn::And(over, find_times<kLens>(m_grid, segment, vertex, open, close));
                    if (hn::AllFalse(kTag, over)) continue;
                    t0 = hn::Min(t0, hn::IfThenElse(over, open, t0));
                    t1 = hn::Max(t1, hn::IfThenElse(over, close, t1));
                }
                m_vector[m_vectors++] = {vertex, j * cluster.n_u + i, bits_of(over)};
            }
        if constexpr (kMoving) {
            first = hn::MinOfLanes(kTag, t0);
            last = hn::MaxOfLanes(kTag, t1);
        }
    }

    template <bool kMoving, Lens kLens>
    HWY_INLINE void add(RowVector& row, int segment, const SegmentPart<kMoving>& during,
                        TilePaths& blocks, SweptBounds<kMoving, kLens>& all) {
        SweptBounds<kMoving, kLens> own(hn::FirstN(kTag, kPacket));
        Extent sum[2], difference[2];
        m_paths.add_corners(segment, row.vertex, during, own, [&]() HWY_ATTR {
            for (int e = 0; e < kEnds<kMoving>; ++e) {
                sum[e].add(own.last_x[e] + own.last_y[e]);
                difference[e].add(own.last_x[e] - own.last_y[e]);
            }
        });
        if constexpr (!kMoving) row.touched &= bits_of(m_paths.find_touching(own, blocks));
        m_bits |= std::uint64_t{row.touched} << row.bin;
        const Extent* const extents[kDirections] = {own.x, own.y, sum, difference};
        for (int d = 0; d < kDirections; ++d)
            for (int e = 0; e < kEnds<kMoving>; ++e) {
                hn::StoreU(extents[d][e].lo, kTag, m_extents[e].lo[d] + row.bin);
                hn::StoreU(extents[d][e].hi, kTag, m_extents[e].hi[d] + row.bin);
            }
        all.merge(own, row.lanes());
    }

    /// Extents in the frame that moves along the path, over all of `part`.  False: too large.
    template <bool kMoving, Lens kLens>
    bool find_extents(const SweptBounds<kMoving, kLens>& all, const SegmentPart<kMoving>& during,
                      const TilePaths& paths) {
        const auto lens = StratumPathFinder::shear_of<kLens>(all.lens, set(m_grid.inverse_farthest),
                                                             set(m_grid.inverse_focus));
        const V slack_x = path_slack(all.margin, all.bend_x, lens.rest, paths.x, m_grid.lens_x);
        const V slack_y = path_slack(all.margin, all.bend_y, lens.rest, paths.y, m_grid.lens_y);
        const V slack[kDirections] = {slack_x, slack_y, slack_x + slack_y, slack_x + slack_y};
        const V ends[2] = {during.time0, during.time1};
        V at[2][kDirections];
        for (int e = 0; e < kEnds<kMoving>; ++e) {
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
        const float samples = m_samples / static_cast<float>(std::max(1, m_grid.segments));
        // False where it is not a number.
        return hn::GetLane(hn::SumOfLanes(kTag, lost)) * samples <
               kSpared * static_cast<float>(std::popcount(m_bits));
    }

    const SimdGrid& m_grid;
    const StratumPathFinder& m_paths;
    float m_samples;           ///< a pixel
    std::uint64_t m_bits = 0;  ///< those over the tile
    RowVector m_vector[kMostVectors];
    int m_vectors = 0;
    ClusterSlices::Extents m_extents[2];  ///< at the ends, raster
    ClusterSlices::Extents m_in_frame;    ///< over the whole part
};
