// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/layer_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/resolve/layer_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "hider/packet_vectors.inl"
#include "hider/vector_fragments.inl"

using HalfTag = hn::Half<Tag>;
using WideTag = hn::Rebind<double, HalfTag>;
using W = hn::Vec<WideTag>;
constexpr HalfTag kHalfTag;
constexpr WideTag kWideTag;

/// A layer of a vector of lists: opacity within [0, 1] and radiance, 0 where there is none.
struct Layer {
    V opacity[3], radiance[3];
    M holdout;
    bool colored;  ///< some lane's opacity
};

/// The lists of a packet, a vector of them at a time.
class PacketCompositor {
  public:
    PacketCompositor(const FragmentLists& lists, std::size_t packet, const LayerTable& table,
                     const RefinedSamples& refined, const ListEnd& end, LayerVisitor* visitor,
                     PacketLayers& out)
        : m_lists(lists),
          m_packet(packet),
          m_slot(static_cast<std::uint32_t>(packet * kPacket)),
          m_table(table),
          m_refined(refined.any_layers() ? &refined : nullptr),
          m_end(end),
          m_visitor(visitor),
          m_out(out) {}

    void run() {
        fetch_ahead(m_lists, m_packet + 2, true);
        clear();
        for (m_part = 0; m_part < kPacket; m_part += lane_count()) {
            const auto count = hn::LoadU(kIdTag, m_lists.counts() + m_slot + m_part);
            m_colored = false;
            fetch_rows(0);
            std::uint32_t following = ~0u;  // lanes
            for (std::uint32_t k = 0;; ++k) {
                const M valid = hn::RebindMask(kTag, hn::Gt(count, hn::Set(kIdTag, k)));
                following &= bits_of(valid);
                if (following == 0) break;
                fetch_lookups(k);
                fetch_rows(k + 1);
                following &= ~add_layer(k, following);
            }
            if (!m_colored) spread();
        }
    }

  private:
    void clear() {
        for (int i = 0; i < kPacket; ++i) {
            m_out.transmission[0][i] = 1.0;
            m_out.alpha[i] = m_out.cut[i] = m_out.opacity[0][i] = 0.0;
            for (int c = 0; c < 3; ++c) m_out.color[c][i] = 0.0;
            m_out.first_key[i] = -std::numeric_limits<float>::infinity();
        }
        m_out.ended = m_out.first_cuts = 0;
    }

    /// What layer k of the next packet looks like, whose lists have come by now.  Lookups and rows
    /// lie all over a bucket's table, beyond the caches near the core: four fifths of the time here
    /// went by waiting for them.  (Always inline: see fetch_ahead.)
    HWY_INLINE void fetch_lookups(std::uint32_t k) const {
        if (m_packet + 1 >= m_lists.packets()) return;
        const std::uint32_t* const counts = m_lists.counts() + m_slot + kPacket + m_part;
        for (int i = 0; i < lane_count(); ++i)
            if (counts[i] > k)
                hwy::Prefetch(&m_table.look(m_lists.layer(m_packet + 1, k).head[m_part + i].id));
    }

    /// The rows of layer k of this one, whose looks have.
    HWY_INLINE void fetch_rows(std::uint32_t k) const {
        const std::uint32_t* const counts = m_lists.counts() + m_slot + m_part;
        for (int i = 0; i < lane_count(); ++i) {
            if (counts[i] <= k) continue;
            const FragmentLayer& fragments = m_lists.layer(m_packet, k);
            const LayerLook& look = m_table.look(fragments.head[m_part + i].id);
            if (!(look.flags & LayerLook::kVaries)) continue;
            const bool second = std::signbit(fragments.weights[m_part + i].signed_b1);
            hwy::Prefetch(m_table.row(look.row[0]));
            hwy::Prefetch(m_table.row(look.row[2]));
            hwy::Prefetch(m_table.row(look.row[second ? 3 : 1]));
        }
    }

    /// Layer k of the lanes; returns those that are complete.
    HWY_INLINE std::uint32_t add_layer(std::uint32_t k, std::uint32_t lanes) {
        const FragmentLayer& fragments = m_lists.layer(m_packet, k);
        const Layer layer = look(fragments, k, lanes);
        if (HWY_UNLIKELY(!m_colored && layer.colored)) spread();
        const std::uint32_t first = find_first(layer, fragments, lanes);
        const std::uint32_t adding = lanes & ~(m_out.ended >> m_part);
        if (HWY_UNLIKELY(m_visitor != nullptr)) visit(k, lanes, first, adding);
        const M adds = mask_of(adding);
        m_colored ? accumulate<true>(layer, adds) : accumulate<false>(layer, adds);
        if (m_end.opacity_threshold < 1.0f) {
            m_out.ended |= (reached() & adding) << m_part;
            const V found = hn::Load(kTag, m_out.first_key + m_part);
            return (m_out.ended >> m_part) &
                   bits_of(hn::Gt(found, set(-std::numeric_limits<float>::infinity())));
        }
        return 0;
    }

    static HWY_INLINE M mask_of(std::uint32_t lanes) {
        const auto bit = hn::Shl(hn::Set(kIdTag, 1), hn::Iota(kIdTag, 0));
        return hn::RebindMask(kTag, hn::TestBit(hn::Set(kIdTag, lanes), bit));
    }

    /// Lane by lane into rows of eight floats, which are then turned into vectors: it costs the
    /// same whether neighbours see one micropolygon or, as in motion, each its own.
    HWY_INLINE Layer look(const FragmentLayer& fragments, std::uint32_t k,
                          std::uint32_t lanes) const {
        alignas(64) float rows[2][4 * kPacket];
        std::uint32_t flags = 0;
        for (int i = 0; i < lane_count(); ++i) {
            const FragmentLayer::Head& head = fragments.head[m_part + i];
            const LayerLook& look = lanes >> i & 1u ? look_of_lane(i, k, head.id) : m_nothing;
            const auto* const from = reinterpret_cast<const char*>(&look);
            std::memcpy(rows[0] + 4 * i, from, sizeof look / 2);
            std::memcpy(rows[1] + 4 * i, from + sizeof look / 2, sizeof look / 2);
            flags |= look.flags;
            if (look.flags & LayerLook::kVaries)
                interpolate(look, fragments.weights[m_part + i], rows[0] + 4 * i, rows[1] + 4 * i);
        }
        Layer layer;
        V flag_bits, unused;
        hn::LoadInterleaved4(kTag, rows[0], layer.opacity[0], layer.opacity[1], layer.opacity[2],
                             layer.radiance[0]);
        hn::LoadInterleaved4(kTag, rows[1], layer.radiance[1], layer.radiance[2], flag_bits,
                             unused);
        layer.colored = (flags & LayerLook::kColored) != 0;
        layer.holdout = hn::RebindMask(kTag, hn::TestBit(hn::BitCast(kIdTag, flag_bits),
                                                         hn::Set(kIdTag, LayerLook::kHoldout)));
        return layer;
    }

    HWY_INLINE const LayerLook& look_of_lane(int lane, std::uint32_t k, SurfaceId id) const {
        if (HWY_UNLIKELY(m_refined != nullptr)) {
            const auto slot = m_slot + static_cast<std::uint32_t>(m_part + lane);
            if (const LayerLook* own = m_refined->look(slot, k)) return *own;
        }
        return m_table.look(id);
    }

    /// The row where the fragment is, in two halves.
    HWY_INLINE void interpolate(const LayerLook& look, const FragmentLayer::Weights& weights,
                                float* first, float* second) const {
        constexpr hn::FixedTag<float, 4> d;
        const bool is_second = std::signbit(weights.signed_b1);
        const float b1 = std::fabs(weights.signed_b1), b2 = weights.b2;
        // None is negative, so that no value leaves the range of its corners (OpacityBounds).
        const float b0 = std::max(0.0f, 1.0f - b1 - b2);
        const float* const row[] = {m_table.row(look.row[0]),
                                    m_table.row(look.row[is_second ? 2 : 1]),
                                    m_table.row(look.row[is_second ? 3 : 2])};
        const auto value = [&](int from) HWY_ATTR {
            return hn::Set(d, b0) * hn::LoadU(d, row[0] + from) +
                   hn::Set(d, b1) * hn::LoadU(d, row[1] + from) +
                   hn::Set(d, b2) * hn::LoadU(d, row[2] + from);
        };
        const auto opacity = value(0);
        // Not a number: clear.
        const auto clamped =
            hn::IfThenElseZero(hn::Gt(opacity, hn::Zero(d)), hn::Min(opacity, hn::Set(d, 1.0f)));
        const auto is_opacity = hn::FirstN(d, 3);
        hn::StoreU(hn::IfThenElse(is_opacity, clamped, opacity), d, first);
        hn::StoreU(value(4), d, second);
        second[2] = std::bit_cast<float>(look.flags);
    }

    /// Lanes whose first surface this layer is.
    HWY_INLINE std::uint32_t find_first(const Layer& layer, const FragmentLayer& fragments,
                                        std::uint32_t lanes) {
        const V found = hn::Load(kTag, m_out.first_key + m_part);
        M first =
            hn::And(mask_of(lanes), hn::Eq(found, set(-std::numeric_limits<float>::infinity())));
        if (hn::AllFalse(kTag, first)) return 0;
        if (m_end.pass_alpha_threshold > 0.0f) first = hn::And(first, covers_enough(layer));
        if (HWY_UNLIKELY(m_refined != nullptr)) first = hn::And(first, is_there(layer));
        V key, id;
        load_heads(fragments, m_part, key, id);
        hn::Store(hn::IfThenElse(first, key, found), kTag, m_out.first_key + m_part);
        const std::uint32_t bits = bits_of(first);
        m_out.first_cuts |= (bits_of(layer.holdout) & bits) << m_part;
        return bits;
    }

    /// Not where a sample has found a hole: nothing of what is clear at all corners is in lists.
    HWY_NOINLINE M is_there(const Layer& layer) const {
        V all = hn::Zero(kTag);
        for (int c = 0; c < 3; ++c)
            all = all + hn::Abs(layer.opacity[c]) + hn::Abs(layer.radiance[c]);
        return hn::Gt(all, hn::Zero(kTag));
    }

    HWY_NOINLINE M covers_enough(const Layer& layer) const {
        alignas(64) float opacity[3][kPacket], enough[kPacket] = {};
        for (int c = 0; c < 3; ++c) hn::Store(layer.opacity[c], kTag, opacity[c]);
        for (int i = 0; i < lane_count(); ++i) {
            const double mean = channel_mean(opacity[0][i], opacity[1][i], opacity[2][i]);
            enough[i] = mean >= m_end.pass_alpha_threshold ? 1.0f : 0.0f;
        }
        return hn::Gt(hn::Load(kTag, enough), set(0.0f));
    }

    HWY_NOINLINE void visit(std::uint32_t k, std::uint32_t lanes, std::uint32_t first,
                            std::uint32_t adds) const {
        for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
            const int lane = __builtin_ctz(rest), i = m_part + lane;
            const Vec3d transmission(m_out.transmission[0][i],
                                     m_out.transmission[m_colored ? 1 : 0][i],
                                     m_out.transmission[m_colored ? 2 : 0][i]);
            const std::uint32_t slot = m_slot + static_cast<std::uint32_t>(i);
            m_visitor->layer(slot, k, m_lists.at(slot, k), (first >> lane & 1u) != 0,
                             (adds >> lane & 1u) != 0, transmission);
        }
    }

    /// The lower and the upper half of a vector, in double.
    static HWY_INLINE W wide(V v, int half) {
        return hn::PromoteTo(kWideTag,
                             half == 0 ? hn::LowerHalf(kHalfTag, v) : hn::UpperHalf(kHalfTag, v));
    }

    /// Until a coloured layer comes, the channels of transmission and opacity are one.
    template <bool kColored>
    HWY_INLINE void accumulate(const Layer& layer, M adds) {
        V opacity[3], radiance[3];
        for (int c = 0; c < 3; ++c) {
            opacity[c] = hn::IfThenElseZero(adds, layer.opacity[c]);
            radiance[c] = hn::IfThenElseZero(adds, layer.radiance[c]);
        }
        const bool holdouts = !hn::AllFalse(kTag, layer.holdout);
        constexpr int kChannels = kColored ? 3 : 1;
        for (int half = 0; half < 2; ++half) {
            const int at = m_part + half * static_cast<int>(hn::Lanes(kWideTag));
            const auto increase = [&](double* sum, W by) HWY_ATTR {
                hn::Store(hn::Load(kWideTag, sum) + by, kWideTag, sum);
            };
            W transmission[3], covered[3];
            for (int c = 0; c < kChannels; ++c) {
                transmission[c] = hn::Load(kWideTag, m_out.transmission[c] + at);
                covered[c] = wide(opacity[c], half) * transmission[c];
            }
            for (int c = 0; c < 3; ++c)
                increase(m_out.color[c] + at,
                         transmission[kColored ? c : 0] * wide(radiance[c], half));
            for (int c = 0; c < kChannels; ++c) {
                if (m_end.opacity_threshold < 1.0f) increase(m_out.opacity[c] + at, covered[c]);
                hn::Store(transmission[c] - covered[c], kWideTag, m_out.transmission[c] + at);
            }
            W mean = covered[0];
            if constexpr (kColored)
                mean = mean + ((covered[1] - mean) + (covered[2] - mean)) / hn::Set(kWideTag, 3.0);
            if (HWY_LIKELY(!holdouts)) {
                increase(m_out.alpha + at, mean);
                continue;
            }
            const W cuts = wide(hn::IfThenElseZero(layer.holdout, set(1.0f)), half);
            increase(m_out.cut + at, mean * cuts);
            increase(m_out.alpha + at, mean * (hn::Set(kWideTag, 1.0) - cuts));
        }
    }

    /// Lanes whose least channel of opacity has come to the threshold.
    HWY_INLINE std::uint32_t reached() const {
        const W threshold = hn::Set(kWideTag, static_cast<double>(m_end.opacity_threshold));
        std::uint32_t lanes = 0;
        for (int half = 0; half < 2; ++half) {
            const int from = half * static_cast<int>(hn::Lanes(kWideTag));
            W least = hn::Load(kWideTag, m_out.opacity[0] + m_part + from);
            for (int c = 1; c < (m_colored ? 3 : 1); ++c)
                least = hn::Min(least, hn::Load(kWideTag, m_out.opacity[c] + m_part + from));
            std::uint8_t bits[8] = {};
            hn::StoreMaskBits(kWideTag, hn::Ge(least, threshold), bits);
            lanes |= std::uint32_t{bits[0]} << from;
        }
        return lanes;
    }

    /// From here on channels have their own transmission and opacity.
    HWY_NOINLINE void spread() {
        m_colored = true;
        for (int c = 1; c < 3; ++c)
            for (int i = m_part; i < m_part + lane_count(); ++i) {
                m_out.transmission[c][i] = m_out.transmission[0][i];
                m_out.opacity[c][i] = m_out.opacity[0][i];
            }
    }

    const FragmentLists& m_lists;
    std::size_t m_packet;
    std::uint32_t m_slot;  ///< first of the packet
    const LayerTable& m_table;
    const RefinedSamples* m_refined;  ///< nullptr: none
    const ListEnd& m_end;
    LayerVisitor* m_visitor;
    PacketLayers& m_out;
    const LayerLook m_nothing;
    int m_part = 0;  ///< first lane of the vector at hand
    bool m_colored = false;
};

void composite_lanes(const FragmentLists& lists, std::size_t packet, const LayerTable& table,
                     const RefinedSamples& refined, const ListEnd& end, LayerVisitor* visitor,
                     PacketLayers& out) {
    PacketCompositor(lists, packet, table, refined, end, visitor, out).run();
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(composite_lanes);

void composite_packet(const FragmentLists& lists, std::size_t packet, const LayerTable& table,
                      const RefinedSamples& refined, const ListEnd& end, LayerVisitor* visitor,
                      PacketLayers& out) {
    HWY_DYNAMIC_DISPATCH(composite_lanes)(lists, packet, table, refined, end, visitor, out);
}

}  // namespace granita
#endif
