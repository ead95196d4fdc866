// SPDX-License-Identifier: GPL-3.0-or-later
// Fragments of neighbours in a packet, a vector of each field: included once a SIMD target inside
// its namespace, after packet_vectors.inl.

/// `id`: the bits of SurfaceId.
struct FragmentVectors {
    V key, id, signed_b1, b2;
};

HWY_INLINE FragmentVectors load_fragments(const Fragment* from) {
    FragmentVectors f;
    hn::LoadInterleaved4(kTag, reinterpret_cast<const float*>(from), f.key, f.id, f.signed_b1,
                         f.b2);
    return f;
}

HWY_INLINE void store_fragments(const FragmentVectors& f, float* to) {
    hn::StoreInterleaved4(f.key, f.id, f.signed_b1, f.b2, kTag, to);
}

/// Of each float of kPacket fragments, whose it is.
alignas(64) constexpr std::array<std::uint32_t, 4 * kPacket> kFragmentBits = [] {
    std::array<std::uint32_t, 4 * kPacket> bits{};
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = 1u << (i / 4);
    return bits;
}();

/// To the lists of the slots from `first` on that the mask names; a vector of them lies in one
/// packet.  Most lists of a packet are as long, so that one layer takes all: four masked stores.
HWY_INLINE void add_fragments(const FragmentVectors& added, M mask, std::size_t first,
                              FragmentLists& lists) {
    alignas(64) float fragments[4 * kPacket];
    store_fragments(added, fragments);
    std::uint32_t* const counts = lists.counts() + first;
    const auto length = hn::LoadU(kIdTag, counts);
    for (std::uint32_t pending = bits_of(mask); pending != 0;) {
        const std::uint32_t layer = counts[__builtin_ctz(pending)];
        const std::uint32_t these =
            pending & bits_of(hn::RebindMask(kTag, hn::Eq(length, hn::Set(kIdTag, layer))));
        pending &= ~these;
        auto* const to =
            reinterpret_cast<float*>(lists.next_layer(first / kPacket, layer) + first % kPacket);
        const auto lanes = hn::Set(kIdTag, these);
        for (int part = 0; part < 4; ++part) {
            const int at = part * lane_count();
            const auto bit = hn::Load(kIdTag, kFragmentBits.data() + at);
            hn::BlendedStore(hn::Load(kTag, fragments + at),
                             hn::RebindMask(kTag, hn::TestBit(lanes, bit)), kTag, to + at);
        }
    }
    const auto one = hn::IfThenElseZero(hn::RebindMask(kIdTag, mask), hn::Set(kIdTag, 1));
    hn::StoreU(length + one, kIdTag, counts);
}
