// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/sample_lists.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hider/samples/sample_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/sample_lists.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef GRANITA_LIST_ENDS
#define GRANITA_LIST_ENDS
namespace granita {
namespace {

static_assert(FragmentLists::kLanes == kPacket);

constexpr float kBehindAll = -std::numeric_limits<float>::infinity();

/// Fragments of a packet's slots while they are sorted, by layer and field.
struct Layer {
    alignas(64) float key[kPacket], id[kPacket], signed_b1[kPacket], b2[kPacket];

    SurfaceId surface(int lane) const { return std::bit_cast<SurfaceId>(id[lane]); }
};

struct Before {
    const GridPool& pool;
    bool operator()(const Fragment& a, const Fragment& b) const {
        if (a.key != b.key) return a.key > b.key;
        return a.id != b.id && pool.before(a.id, b.id);
    }
};

/// One slot by itself, for long lists that came in another order.
void sort_lane(std::vector<Layer>& layers, std::size_t count, int lane,
               std::vector<Fragment>& scratch, const Before& before) {
    scratch.clear();
    for (std::size_t k = 0; k < count; ++k) {
        const Layer& l = layers[k];
        Fragment& f = scratch.emplace_back();
        f.key = l.key[lane];
        f.id = l.surface(lane);
        f.signed_b1 = l.signed_b1[lane];
        f.b2 = l.b2[lane];
    }
    // What has been taken out is behind all.
    const auto end = std::partition(scratch.begin(), scratch.end(),
                                    [](const Fragment& f) { return f.key > kBehindAll; });
    std::sort(scratch.begin(), end, before);
    for (std::size_t k = 0; k < count; ++k) {
        const Fragment& f = scratch[k];
        layers[k].key[lane] = f.key;
        layers[k].id[lane] = std::bit_cast<float>(f.id);
        layers[k].signed_b1[lane] = f.signed_b1;
        layers[k].b2[lane] = f.b2;
    }
}

/// Ends a slot's sorted list; returns how many fragments are left.
std::uint32_t cut_lane(std::vector<Layer>& layers, std::uint32_t count, int lane,
                       const GridPool& pool, const ListEnd& end, float& surface_key,
                       SurfaceId& surface_id) {
    double clear = 1.0;
    bool seen = end.pass_alpha_threshold <= 0.0f, ended = false;
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        const OpacityBounds& opacity = pool.opacity(layers[k].surface(lane));
        // Behind the end only the layer that stands for the sample is still looked for.
        if (ended && opacity.most < end.pass_alpha_threshold) continue;
        const float key = layers[k].key[lane];
        if (kept != k) {
            layers[kept].key[lane] = key;
            layers[kept].id[lane] = layers[k].id[lane];
            layers[kept].signed_b1[lane] = layers[k].signed_b1[lane];
            layers[kept].b2[lane] = layers[k].b2[lane];
        }
        ++kept;
        clear *= 1.0 - static_cast<double>(opacity.least);
        seen = seen || opacity.least >= end.pass_alpha_threshold;
        ended = ended || 1.0 - clear >= end.opacity_threshold;
        if (!ended || !seen) continue;
        // Coincident layers that come later may still be sorted before this one.
        const float limit = std::nextafter(key, kBehindAll);
        if (limit > surface_key) {
            surface_key = limit;
            surface_id = kNoSurface;
        }
        break;
    }
    return kept;
}

}  // namespace
}  // namespace granita
#endif

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "hider/packet_vectors.inl"
#include "hider/vector_fragments.inl"

/// The lists of one packet, a vector of slots at a time.
class PacketSorter {
  public:
    PacketSorter(FragmentLists& lists, const OpaqueSurfaces& surfaces, const GridPool& pool,
                 const ListEnd& end, char* seen)
        : m_lists(lists),
          m_surfaces(surfaces),
          m_pool(pool),
          m_before{pool},
          m_end(end),
          m_seen(seen) {}

    void sort(std::size_t packet) {
        // What is in order reads no weights; neighbours mostly are, or are not.
        fetch_ahead(m_lists, packet + 1, m_moved != 0);
        m_moved = 0;
        const std::size_t slot = packet * kPacket;
        std::uint32_t* const counts = m_lists.counts() + slot;
        const std::uint32_t most = *std::max_element(counts, counts + kPacket);
        if (most == 0) return;
        if (m_layers.size() < most) m_layers.resize(most);
        const bool may_end = m_end.opacity_threshold < 1.0f;
        const bool may_drop = may_end && m_end.pass_alpha_threshold > 0.0f;
        for (m_part = 0; m_part < kPacket; m_part += lane_count()) {
            const bool hidden = load(packet, most);
            const std::uint32_t sorted = count_sorted(most);
            if (sorted < most || may_drop) {
                load_weights(packet, most);
                m_moved |= 1u << m_part;
            }
            if (sorted < most) sort_part(counts, sorted, most);
            if (hidden) recount(counts, most);
        }
        if (may_end)
            for (int lane = 0; lane < kPacket; ++lane)
                counts[lane] = cut_lane(m_layers, counts[lane], lane, m_pool, m_end,
                                        m_surfaces.key[slot + lane], m_surfaces.id[slot + lane]);
        for (m_part = 0; m_part < kPacket; m_part += lane_count())
            if (m_moved >> m_part & 1u) store(packet, counts);
        if (!m_seen) return;
        for (int lane = 0; lane < kPacket; ++lane) {
            const std::uint32_t count = counts[lane];  // a char may be anything's
            for (std::uint32_t k = 0; k < count; ++k) m_seen[m_layers[k].surface(lane)] = 1;
        }
    }

  private:
    /// Of the part, with the lanes' fragments that do not count behind all.  Whether any of the
    /// lists' own is among them.
    bool load(std::size_t packet, std::uint32_t most) {
        const std::size_t slot = packet * kPacket;
        const V behind_all = set(kBehindAll);
        const V surface = hn::LoadU(kTag, m_surfaces.key + slot + m_part);
        const auto count = hn::LoadU(kIdTag, m_lists.counts() + slot + m_part);
        bool hidden = false;
        for (std::uint32_t k = 0; k < most; ++k) {
            Layer& to = m_layers[k];
            V key, id;
            load_heads(m_lists.layer(packet, k), m_part, key, id);
            const M valid = hn::RebindMask(kTag, hn::Gt(count, hn::Set(kIdTag, k)));
            M counts = hn::And(valid, hn::Gt(key, surface));
            const M equal = hn::And(valid, hn::Eq(key, surface));
            hn::Store(id, kTag, to.id + m_part);
            if (HWY_UNLIKELY(!hn::AllFalse(kTag, equal)))
                counts = hn::Or(counts, of_lanes(equal, [&](int lane) {
                                    const SurfaceId opaque = m_surfaces.id[slot + lane];
                                    return opaque != kNoSurface &&
                                           m_pool.before(to.surface(lane), opaque);
                                }));
            hidden |= !hn::AllFalse(kTag, hn::AndNot(counts, valid));
            hn::Store(hn::IfThenElse(counts, key, behind_all), kTag, to.key + m_part);
        }
        return hidden;
    }

    /// The lanes of the mask, numbered within the packet, of which `is` is true.
    template <class Is>
    HWY_INLINE M of_lanes(M mask, Is is) const {
        alignas(64) float chosen[kPacket] = {};
        for (std::uint32_t bits = bits_of(mask); bits != 0; bits &= bits - 1) {
            const int lane = __builtin_ctz(bits);
            chosen[lane] = is(m_part + lane) ? 1.0f : 0.0f;
        }
        return hn::Gt(hn::Load(kTag, chosen), set(0.0f));
    }

    void load_weights(std::size_t packet, std::uint32_t most) {
        for (std::uint32_t k = 0; k < most; ++k) {
            V signed_b1, b2;
            HWY_NAMESPACE::load_weights(m_lists.layer(packet, k), m_part, signed_b1, b2);
            hn::Store(signed_b1, kTag, m_layers[k].signed_b1 + m_part);
            hn::Store(b2, kTag, m_layers[k].b2 + m_part);
        }
    }

    /// Layers that are in order as they are.
    std::uint32_t count_sorted(std::uint32_t most) const {
        std::uint32_t sorted = 1;
        while (sorted < most && hn::AllFalse(kTag, out_of_order(sorted))) ++sorted;
        return sorted;
    }

    /// By insertion, all lanes at once: grids come roughly from front to back, and lists are short.
    void sort_part(const std::uint32_t* counts, std::uint32_t sorted, std::uint32_t most) {
        constexpr std::uint32_t kShort = 64;
        if (most > kShort) {
            for (int lane = m_part; lane < m_part + lane_count(); ++lane)
                sort_lane(m_layers, counts[lane], lane, m_scratch, m_before);
            return;
        }
        for (; sorted < most; ++sorted)
            for (std::uint32_t k = sorted; k > 0; --k) {
                const M swap = out_of_order(k);
                if (hn::AllFalse(kTag, swap)) break;
                exchange(swap, m_layers[k - 1].key, m_layers[k].key);
                exchange(swap, m_layers[k - 1].id, m_layers[k].id);
                exchange(swap, m_layers[k - 1].signed_b1, m_layers[k].signed_b1);
                exchange(swap, m_layers[k - 1].b2, m_layers[k].b2);
            }
    }

    /// Lanes in which layer k belongs before the one before it.
    HWY_INLINE M out_of_order(std::uint32_t k) const {
        const Layer &a = m_layers[k - 1], &b = m_layers[k];
        const V first = hn::Load(kTag, a.key + m_part), second = hn::Load(kTag, b.key + m_part);
        const M nearer = hn::Gt(second, first);
        const M equal = hn::And(hn::Eq(second, first), hn::Gt(second, set(kBehindAll)));
        if (HWY_LIKELY(hn::AllFalse(kTag, equal))) return nearer;
        return hn::Or(nearer, of_lanes(equal, [&](int lane) {
                          return m_pool.before(b.surface(lane), a.surface(lane));
                      }));
    }

    HWY_INLINE void exchange(M mask, float* a, float* b) const {
        const V x = hn::Load(kTag, a + m_part), y = hn::Load(kTag, b + m_part);
        hn::Store(hn::IfThenElse(mask, y, x), kTag, a + m_part);
        hn::Store(hn::IfThenElse(mask, x, y), kTag, b + m_part);
    }

    /// What does not count is behind all: a list ends before it.
    void recount(std::uint32_t* counts, std::uint32_t most) const {
        for (int lane = m_part; lane < m_part + lane_count(); ++lane) {
            std::uint32_t count = 0;
            while (count < most && m_layers[count].key[lane] > kBehindAll) ++count;
            counts[lane] = count;
        }
    }

    void store(std::size_t packet, const std::uint32_t* counts) {
        const std::uint32_t most = *std::max_element(counts, counts + kPacket);
        for (std::uint32_t k = 0; k < most; ++k) {
            const Layer& from = m_layers[k];
            store_fragments(
                {hn::Load(kTag, from.key + m_part), hn::Load(kTag, from.id + m_part),
                 hn::Load(kTag, from.signed_b1 + m_part), hn::Load(kTag, from.b2 + m_part)},
                m_lists.layer(packet, k), m_part);
        }
    }

    FragmentLists& m_lists;
    const OpaqueSurfaces& m_surfaces;
    const GridPool& m_pool;
    Before m_before;
    const ListEnd& m_end;
    char* m_seen;
    int m_part = 0;             ///< first lane of the vector at hand
    std::uint32_t m_moved = 0;  ///< parts of the packet, by first lane, to be stored
    std::vector<Layer> m_layers;
    std::vector<Fragment> m_scratch;
};

void sort_packets(FragmentLists& lists, const OpaqueSurfaces& surfaces, const GridPool& pool,
                  const ListEnd& end, char* seen) {
    PacketSorter sorter(lists, surfaces, pool, end, seen);
    for (std::size_t p = 0; p < lists.packets(); ++p) sorter.sort(p);
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(sort_packets);

void sort_lists(FragmentLists& lists, const OpaqueSurfaces& surfaces, const GridPool& pool,
                const ListEnd& end, char* seen) {
    if (lists.empty()) return;
    HWY_DYNAMIC_DISPATCH(sort_packets)(lists, surfaces, pool, end, seen);
}

}  // namespace granita
#endif
