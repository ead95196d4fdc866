// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of samples against one micropolygon: included once a SIMD target inside its namespace,
// after packet_vectors.inl, sample_packet.inl and tile_bounds.inl.

/// The micropolygon that is looked at, or several of the grid.
struct Target {
    int kind = 0;      ///< SimdGrid::classes; of several: bits that any has
    SurfaceId id = 0;  ///< of one
    int segment = 0;   ///< of its motion
};

/// Where a vector of samples meets the micropolygon; weights as in Fragment.
struct Hits {
    V key, signed_b1, b2;
};

class SampleTest {
  public:
    SampleTest(const SimdGrid& grid, const Target& target)
        : m_grid(grid), m_target(target), m_appears(!grid.lifespan.is_whole()) {}

    /// A vector of samples against the target, or each against its own of a ShapeVector: which are
    /// covered, and where.
    template <bool kMoving, Lens kLens, class S>
    HWY_INLINE M covers(const S& shape, Samples at, M valid, Hits& hits) {
        const V zero = set(0.0f);
        const V local = kMoving ? local_time(shape, at) : zero;
        const Offset<V> d0 = offset<kLens>(corner_at<kMoving>(shape, 0, local), at);
        const Offset<V> d1 = offset<kLens>(corner_at<kMoving>(shape, 1, local), at);
        const Offset<V> d2 = offset<kLens>(corner_at<kMoving>(shape, 2, local), at);
        const Offset<V> d3 = offset<kLens>(corner_at<kMoving>(shape, 3, local), at);
        const PairEdges e = edges_of(d0, d1, d2, d3);
        const Side a = within(shape.lanes_with(kTriangleA), first_side(e));
        const Side b = within(shape.lanes_with(kTriangleB), second_side(e));
        M touched = hn::And(valid, hn::Or(a.in, b.in));
        if (hn::AllFalse(kTag, touched)) return touched;
        if (kMoving && m_grid.segments > 1) {
            touched = hn::And(touched, hn::Ge(local, zero));
            const M last = hn::Eq(shape.segment(), set(static_cast<float>(m_grid.segments - 1)));
            touched = hn::And(touched, hn::Or(last, hn::Lt(local, set(1.0f))));
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

  private:
    /// Hits by way of memory, with the samples' coordinates as far as there are.
    struct Exact {
        alignas(64) float key[kPacket], hit[kPacket], signed_b1[kPacket], b2[kPacket];
        alignas(64) float samples[Samples::kCoordinates][kPacket];
    };

    /// Time of the samples in the segment, which may lie outside [0, 1].
    template <class S>
    HWY_INLINE V local_time(const S& shape, const Samples& at) const {
        return at.t * set(static_cast<float>(m_grid.segments)) - shape.segment();
    }

    template <bool kMoving, class S>
    static HWY_INLINE Corner<V> corner_at(const S& shape, int k, V local) {
        const Corner<V> begin = shape.begin_of(k);
        if constexpr (!kMoving) return begin;
        return at_time(begin, shape.delta_of(k), local);
    }

    static HWY_INLINE Side within(M lanes, const Side& side) {
        return {hn::And(lanes, side.in), hn::And(lanes, side.strict)};
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

    template <bool kMoving, Lens kLens, class S>
    HWY_NOINLINE void test_exactly(const S& shape, M unclear, Exact& exact) {
        Samples at;
        at.for_each<kMoving, kLens>([&](V& value, int k)
                                        HWY_ATTR { value = hn::LoadU(kTag, exact.samples[k]); });
        const V local = kMoving ? local_time(shape, at) : set(0.0f);
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
            const SurfaceHit hit = hit_micropolygon(
                corner, offset, static_cast<std::uint8_t>(shape.kind(lane)), m_grid.range);
            const Fragment fragment = fragment_of(hit, m_target.id);
            exact.key[lane] = fragment.key;
            exact.hit[lane] = hit.hit ? 1.0f : 0.0f;
            exact.signed_b1[lane] = fragment.signed_b1;
            exact.b2[lane] = fragment.b2;
        });
    }

    const SimdGrid& m_grid;
    const Target& m_target;
    const bool m_appears;  ///< or vanishes
};
