// SPDX-License-Identifier: GPL-3.0-or-later
// The transparent surfaces over a tile's samples, one list a sample.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/slab_memory.h"
#include "hider/micropolygon.h"

namespace granita {

/// A transparent surface over a sample, and where the sample meets it: found once, while hiding.
struct Fragment {
    float key;  ///< depth key, larger is nearer
    SurfaceId id;
    float signed_b1, b2;  ///< weights of the triangle's second and third corner, below

    Fragment() = default;
    Fragment(float depth_key, SurfaceId surface, float b1, float b2_, bool second_triangle)
        : key(depth_key),
          id(surface),
          signed_b1(std::copysign(b1, second_triangle ? -1.0f : 1.0f)),
          b2(b2_) {}
    float b1() const { return std::fabs(signed_b1); }
    /// Triangle (0, 2, 3) instead of (0, 1, 2).
    bool second() const { return std::signbit(signed_b1); }
};
static_assert(sizeof(Fragment) == 16);

inline Fragment fragment_of(const SurfaceHit& hit, SurfaceId id) {
    return {hit.key, id, static_cast<float>(hit.b1), static_cast<float>(hit.b2), hit.second};
}

/// The lists of kLanes slots lie side by side: layer k of the packet is the k-th fragments of its
/// slots, so that sorting and compositing take a layer at a time.  A slot is a sample by its index
/// in the table, or by its place in `order`.
class FragmentLists {
  public:
    static constexpr std::uint32_t kLanes = 16;

    FragmentLists() = default;
    FragmentLists(FragmentLists&&) = default;
    FragmentLists& operator=(FragmentLists&&) = default;

    /// No lists.  What they had of SlabMemory is not given back: it may be gone.
    void reset();
    /// Before add(): empty lists, unless there are some.  `slots`: a multiple of kLanes.  The
    /// memory must outlive the lists.
    void prepare(std::size_t slots, SlabMemory& memory) {
        if (m_counts.empty()) begin(slots, memory);
    }
    /// Empties the lists, gives their memory back.
    void clear();
    void add(std::uint32_t slot, const Fragment& fragment) {
        next_layer(slot / kLanes, m_counts[slot]++)[slot % kLanes] = fragment;
    }
    /// [kLanes] where fragment number `layer` of a slot of the packet goes: the list's end.
    Fragment* next_layer(std::size_t packet, std::uint32_t layer) {
        Packet& lists = m_packets[packet];
        if (layer == lists.capacity) grow(lists);
        return lists.layers + std::size_t{layer} * kLanes;
    }

    bool empty() const { return !m_any; }
    std::uint64_t total() const;  ///< fragments
    std::size_t slots() const { return m_counts.size(); }
    std::size_t packets() const { return m_packets.size(); }
    /// [layers][kLanes]; a slot has the first count() of them, what follows is anything.
    Fragment* layers(std::size_t packet) { return m_packets[packet].layers; }
    const Fragment* layers(std::size_t packet) const { return m_packets[packet].layers; }
    /// [slots]
    std::uint32_t* counts() { return m_counts.data(); }
    const std::uint32_t* counts() const { return m_counts.data(); }
    /// Fragment k of the slot.
    Fragment& at(std::uint32_t slot, std::uint32_t k) {
        return layers(slot / kLanes)[std::size_t{k} * kLanes + slot % kLanes];
    }
    const Fragment& at(std::uint32_t slot, std::uint32_t k) const {
        return const_cast<FragmentLists*>(this)->at(slot, k);
    }
    std::uint32_t sample(std::uint32_t slot) const { return order.empty() ? slot : order[slot]; }

    std::vector<std::uint32_t> order;  ///< [slots] sample of a slot; empty: the slot itself

  private:
    struct Packet {
        Fragment* layers = nullptr;
        std::uint32_t capacity = 0;
    };
    void begin(std::size_t slots, SlabMemory& memory);
    void grow(Packet& packet);

    SlabMemory* m_memory = nullptr;
    bool m_any = false;
    std::vector<Packet> m_packets;
    std::vector<std::uint32_t> m_counts;
};

}  // namespace granita
