// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of samples of a packet: included once a SIMD target inside its namespace.

// At most a packet wide, on machines with wider vectors too.
using Tag = hn::CappedTag<float, kPacket>;
using IdTag = hn::RebindToUnsigned<Tag>;
using IntTag = hn::RebindToSigned<Tag>;
using V = hn::Vec<Tag>;
using M = hn::Mask<Tag>;
constexpr Tag kTag;
constexpr IdTag kIdTag;
constexpr IntTag kIntTag;

inline int lane_count() {
    return static_cast<int>(hn::Lanes(kTag));
}
HWY_INLINE V set(float x) {
    return hn::Set(kTag, x);
}
/// Bit i: lane i.
HWY_INLINE std::uint32_t bits_of(M mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kTag, mask, bytes);
    return bytes[0] | (bytes[1] << 8);
}
/// Lane i: bit i.
HWY_INLINE M lanes_of(std::uint32_t bits) {
    const auto bit = hn::Shl(hn::Set(kIdTag, 1), hn::Iota(kIdTag, 0));
    return hn::RebindMask(kTag, hn::TestBit(hn::Set(kIdTag, bits), bit));
}
/// Calls visit(i) for every bit i that is set.
template <class Bits, class Visit>
HWY_INLINE void for_each_bit(Bits bits, Visit visit) {
    for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}
/// Calls visit(lane) for every lane of the mask.
template <class Visit>
HWY_INLINE void for_each_lane(M mask, Visit visit) {
    for_each_bit(bits_of(mask), visit);
}
