// SPDX-License-Identifier: GPL-3.0-or-later
// Fragments of neighbours in a packet, a vector of each field: included once a SIMD target inside
// its namespace, after packet_vectors.inl.

/// `id`: the bits of SurfaceId.
struct FragmentVectors {
    V key, id, signed_b1, b2;
};

HWY_INLINE void load_heads(const FragmentLayer& layer, int first, V& key, V& id) {
    hn::LoadInterleaved2(kTag, &layer.head[first].key, key, id);
}

HWY_INLINE void load_weights(const FragmentLayer& layer, int first, V& signed_b1, V& b2) {
    hn::LoadInterleaved2(kTag, &layer.weights[first].signed_b1, signed_b1, b2);
}

HWY_INLINE void store_fragments(const FragmentVectors& f, FragmentLayer& layer, int first) {
    hn::StoreInterleaved2(f.key, f.id, kTag, &layer.head[first].key);
    hn::StoreInterleaved2(f.signed_b1, f.b2, kTag, &layer.weights[first].signed_b1);
}

/// The packet comes next: its lists as far as its first slot's goes.  Lists lie beyond the caches
/// near the core, each packet's elsewhere.  (Always inline: GCC takes a function that only fetches
/// for one without effect, and drops it.)
HWY_INLINE void fetch_ahead(const FragmentLists& lists, std::size_t packet, bool weights) {
    if (packet >= lists.packets()) return;
    const std::uint32_t count = lists.counts()[packet * kPacket];
    for (std::uint32_t k = 0; k < count; ++k) {
        const FragmentLayer& layer = lists.layer(packet, k);
        hwy::Prefetch(layer.head);
        hwy::Prefetch(layer.head + kPacket / 2);
        if (!weights) continue;
        hwy::Prefetch(layer.weights);
        hwy::Prefetch(layer.weights + kPacket / 2);
    }
}

/// Of each float of kPacket pairs, whose it is.
alignas(64) constexpr std::array<std::uint32_t, 2 * kPacket> kPairBits = [] {
    std::array<std::uint32_t, 2 * kPacket> bits{};
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = 1u << (i / 2);
    return bits;
}();

/// To the lists of the slots from `first` on that the mask names; a vector of them lies in one
/// packet.  Most lists of a packet are as long, so that one layer takes all: four masked stores.
HWY_INLINE void add_fragments(const FragmentVectors& added, M mask, std::size_t first,
                              FragmentLists& lists) {
    FragmentLayer from;
    store_fragments(added, from, 0);
    std::uint32_t* const counts = lists.counts() + first;
    const auto length = hn::LoadU(kIdTag, counts);
    for (std::uint32_t pending = bits_of(mask); pending != 0;) {
        const std::uint32_t k = counts[__builtin_ctz(pending)];
        const std::uint32_t these =
            pending & bits_of(hn::RebindMask(kTag, hn::Eq(length, hn::Set(kIdTag, k))));
        pending &= ~these;
        FragmentLayer& to = lists.next_layer(first / kPacket, k);
        const std::size_t lane = first % kPacket;
        const auto lanes = hn::Set(kIdTag, these);
        for (int part = 0; part < 2; ++part) {
            const int at = part * lane_count();
            const M stored =
                hn::RebindMask(kTag, hn::TestBit(lanes, hn::Load(kIdTag, kPairBits.data() + at)));
            hn::BlendedStore(hn::Load(kTag, &from.head[0].key + at), stored, kTag,
                             &to.head[lane].key + at);
            hn::BlendedStore(hn::Load(kTag, &from.weights[0].signed_b1 + at), stored, kTag,
                             &to.weights[lane].signed_b1 + at);
        }
    }
    const auto one = hn::IfThenElseZero(hn::RebindMask(kIdTag, mask), hn::Set(kIdTag, 1));
    hn::StoreU(length + one, kIdTag, counts);
}
