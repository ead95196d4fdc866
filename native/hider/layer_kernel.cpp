// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/layer_kernel.h"

#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/layer_kernel.cpp"
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
    M holdout, colored;
    V key;
};

/// The lists of a packet, a vector of them at a time.
class PacketCompositor {
  public:
    PacketCompositor(const FragmentLists& lists, std::size_t packet, const LayerTable& table,
                     const ListEnd& end, LayerVisitor* visitor, PacketLayers& out)
        : m_lists(lists),
          m_slot(static_cast<std::uint32_t>(packet * kPacket)),
          m_fragments(lists.layers(packet)),
          m_table(table),
          m_end(end),
          m_visitor(visitor),
          m_out(out) {}

    void run() {
        clear();
        for (m_part = 0; m_part < kPacket; m_part += lane_count()) {
            const auto count = hn::LoadU(kIdTag, m_lists.counts() + m_slot + m_part);
            m_colored = false;
            std::uint32_t following = ~0u;  // lanes
            for (std::uint32_t k = 0;; ++k) {
                const M valid = hn::RebindMask(kTag, hn::Gt(count, hn::Set(kIdTag, k)));
                following &= bits_of(valid);
                if (following == 0) break;
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
        m_out.ended = 0;
    }

    /// Layer k of the lanes; returns those that are complete.
    HWY_INLINE std::uint32_t add_layer(std::uint32_t k, std::uint32_t lanes) {
        const Layer layer = look(m_fragments + k * kPacket + m_part, lanes);
        if (HWY_UNLIKELY(!m_colored && !hn::AllFalse(kTag, layer.colored))) spread();
        const std::uint32_t first = find_first(layer, lanes);
        const std::uint32_t adding = lanes & ~(m_out.ended >> m_part);
        if (HWY_UNLIKELY(m_visitor != nullptr)) visit(k, layer, lanes, first, adding);
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

    /// One micropolygon after another with all lists that have it in this layer: neighbouring
    /// samples see few.
    HWY_INLINE Layer look(const Fragment* fragments, std::uint32_t lanes) const {
        const FragmentVectors f = load_fragments(fragments);
        const auto id = hn::BitCast(kIdTag, f.id);
        const V zero = set(0.0f);
        const M none = hn::MaskFromVec(zero);
        Layer layer{{zero, zero, zero}, {zero, zero, zero}, none, none, f.key};
        for (std::uint32_t pending = lanes; pending != 0;) {
            const SurfaceId surface = fragments[__builtin_ctz(pending)].id;
            const LayerLook& look = m_table.look(surface);
            const M these = hn::RebindMask(kTag, hn::Eq(id, hn::Set(kIdTag, surface)));
            pending &= ~bits_of(these);
            if (look.flags & LayerLook::kColored) layer.colored = hn::Or(layer.colored, these);
            if (look.flags & LayerLook::kHoldout) layer.holdout = hn::Or(layer.holdout, these);
            if (look.flags & LayerLook::kVaries) {
                interpolate(look, f.signed_b1, f.b2, these, layer);
                continue;
            }
            for (int c = 0; c < 3; ++c) {
                layer.opacity[c] = hn::IfThenElse(these, set(look.value[c]), layer.opacity[c]);
                layer.radiance[c] =
                    hn::IfThenElse(these, set(look.value[3 + c]), layer.radiance[c]);
            }
        }
        return layer;
    }

    HWY_INLINE void interpolate(const LayerLook& look, V signed_b1, V b2, M these,
                                Layer& layer) const {
        const V zero = set(0.0f), one = set(1.0f), b1 = hn::Abs(signed_b1);
        const M second =
            hn::MaskFromVec(hn::BitCast(kTag, hn::ShiftRight<31>(hn::BitCast(kIntTag, signed_b1))));
        // None is negative, so that no value leaves the range of its corners (OpacityBounds).
        const V b0 = hn::Max(zero, one - b1 - b2);
        const float* row[4];
        for (int k = 0; k < 4; ++k) row[k] = m_table.row(look.row[k]);
        const auto value = [&](int c) HWY_ATTR {
            const V one_more = set(row[2][c]);
            return b0 * set(row[0][c]) + b1 * hn::IfThenElse(second, one_more, set(row[1][c])) +
                   b2 * hn::IfThenElse(second, set(row[3][c]), one_more);
        };
        for (int c = 0; c < 3; ++c) {
            const V opacity = value(c);
            // Not a number: clear.
            const V clamped = hn::IfThenElseZero(hn::Gt(opacity, zero), hn::Min(opacity, one));
            layer.opacity[c] = hn::IfThenElse(these, clamped, layer.opacity[c]);
            layer.radiance[c] = hn::IfThenElse(these, value(3 + c), layer.radiance[c]);
        }
    }

    /// Lanes whose first surface this layer is.
    HWY_INLINE std::uint32_t find_first(const Layer& layer, std::uint32_t lanes) const {
        const V found = hn::Load(kTag, m_out.first_key + m_part);
        M first =
            hn::And(mask_of(lanes), hn::Eq(found, set(-std::numeric_limits<float>::infinity())));
        if (hn::AllFalse(kTag, first)) return 0;
        if (m_end.pass_alpha_threshold > 0.0f) first = hn::And(first, covers_enough(layer));
        hn::Store(hn::IfThenElse(first, layer.key, found), kTag, m_out.first_key + m_part);
        return bits_of(first);
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

    HWY_NOINLINE void visit(std::uint32_t k, const Layer& layer, std::uint32_t lanes,
                            std::uint32_t first, std::uint32_t adding) const {
        const std::uint32_t adds = adding & ~bits_of(layer.holdout);
        for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
            const int lane = __builtin_ctz(rest), i = m_part + lane;
            const Vec3d transmission(m_out.transmission[0][i],
                                     m_out.transmission[m_colored ? 1 : 0][i],
                                     m_out.transmission[m_colored ? 2 : 0][i]);
            const std::uint32_t slot = m_slot + static_cast<std::uint32_t>(i);
            m_visitor->layer(slot, m_lists.at(slot, k), (first >> lane & 1u) != 0,
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
    std::uint32_t m_slot;  ///< first of the packet
    const Fragment* m_fragments;
    const LayerTable& m_table;
    const ListEnd& m_end;
    LayerVisitor* m_visitor;
    PacketLayers& m_out;
    int m_part = 0;  ///< first lane of the vector at hand
    bool m_colored = false;
};

void composite_lanes(const FragmentLists& lists, std::size_t packet, const LayerTable& table,
                     const ListEnd& end, LayerVisitor* visitor, PacketLayers& out) {
    PacketCompositor(lists, packet, table, end, visitor, out).run();
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(composite_lanes);

void composite_packet(const FragmentLists& lists, std::size_t packet, const LayerTable& table,
                      const ListEnd& end, LayerVisitor* visitor, PacketLayers& out) {
    HWY_DYNAMIC_DISPATCH(composite_lanes)(lists, packet, table, end, visitor, out);
}

}  // namespace granita
#endif
