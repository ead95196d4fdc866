// SPDX-License-Identifier: GPL-3.0-or-later
// The transparent surfaces over a tile's samples, one list a sample.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/arena.h"
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

/// The k-th fragments of sixteen slots.  A hit that is written by itself touches two cache lines;
/// what only sorts or looks micropolygons up reads half.
struct FragmentLayer {
    static constexpr std::uint32_t kLanes = 16;
    struct Head {
        float key;
        SurfaceId id;
    };
    struct Weights {
        float signed_b1, b2;
    };
    alignas(64) Head head[kLanes];
    alignas(64) Weights weights[kLanes];

    void set(std::uint32_t lane, const Fragment& f) {
        head[lane] = {f.key, f.id};
        weights[lane] = {f.signed_b1, f.b2};
    }
    Fragment at(std::uint32_t lane) const {
        Fragment f;
        f.key = head[lane].key;
        f.id = head[lane].id;
        f.signed_b1 = weights[lane].signed_b1;
        f.b2 = weights[lane].b2;
        return f;
    }
};

/// The lists of kLanes slots lie side by side: layer k of the packet is the k-th fragments of its
/// slots, so that sorting and compositing take a layer at a time.  A slot is a sample by its index
/// in the table, or by its place in `order`.  A packet's layers lie in chunks of 4, 4, 8, 16 ...:
/// nothing is copied when lists grow.
class FragmentLists {
  public:
    static constexpr std::uint32_t kLanes = FragmentLayer::kLanes;

    FragmentLists() = default;
    FragmentLists(FragmentLists&&) = default;
    FragmentLists& operator=(FragmentLists&&) = default;

    /// No lists.  What they had of Arena is not given back: it may be gone.
    void reset();
    /// Before add(): empty lists, unless there are some.  `slots`: a multiple of kLanes.  The
    /// memory must outlive the lists.
    void prepare(std::size_t slots, Arena& memory) {
        if (m_counts.empty()) begin(slots, memory);
    }
    /// Empties the lists, gives their memory back.
    void clear();
    void add(std::uint32_t slot, const Fragment& fragment) {
        next_layer(slot / kLanes, m_counts[slot]++).set(slot % kLanes, fragment);
    }
    /// Where fragment number `k` of a slot of the packet goes: the list's end.
    FragmentLayer& next_layer(std::size_t packet, std::uint32_t k) {
        const std::uint32_t c = chunk_of(k);
        if (c >= m_stride || !m_chunks[packet * m_stride + c]) grow(packet, c);
        return layer(packet, k);
    }

    bool empty() const { return !m_any; }
    std::uint64_t total() const;  ///< fragments
    std::size_t slots() const { return m_counts.size(); }
    std::size_t packets() const { return m_counts.size() / kLanes; }
    /// Of slots with fewer fragments it is anything.  k: less than the packet's largest count.
    FragmentLayer& layer(std::size_t packet, std::uint32_t k) {
        const std::uint32_t c = chunk_of(k);
        return m_chunks[packet * m_stride + c][k - first_of(c)];
    }
    const FragmentLayer& layer(std::size_t packet, std::uint32_t k) const {
        return const_cast<FragmentLists*>(this)->layer(packet, k);
    }
    /// [slots]
    std::uint32_t* counts() { return m_counts.data(); }
    const std::uint32_t* counts() const { return m_counts.data(); }
    /// Fragment k of the slot.
    Fragment at(std::uint32_t slot, std::uint32_t k) const {
        return layer(slot / kLanes, k).at(slot % kLanes);
    }
    void set(std::uint32_t slot, std::uint32_t k, const Fragment& fragment) {
        layer(slot / kLanes, k).set(slot % kLanes, fragment);
    }
    std::uint32_t sample(std::uint32_t slot) const { return order.empty() ? slot : order[slot]; }

    std::vector<std::uint32_t> order;  ///< [slots] sample of a slot; empty: the slot itself

  private:
    static constexpr std::uint32_t kFirst = 4;  ///< layers of the first chunk
    static std::uint32_t chunk_of(std::uint32_t k) {
        return static_cast<std::uint32_t>(std::bit_width(k / kFirst));
    }
    static std::uint32_t first_of(std::uint32_t chunk) { return (kFirst << chunk >> 1) & -kFirst; }
    void begin(std::size_t slots, Arena& memory);
    static int block_log2(std::uint32_t chunk);
    void grow(std::size_t packet, std::uint32_t chunk);

    Arena* m_memory = nullptr;
    bool m_any = false;
    std::uint32_t m_stride = 0;            ///< chunks that each packet has a place for
    std::vector<FragmentLayer*> m_chunks;  ///< [packets][m_stride]
    std::vector<std::uint32_t> m_counts;
};

}  // namespace granita
