// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps by place and direction, for scenes that have too many to ask each (Conty Estevez and Kulla
// 2018), eight children a node: what each can give at most to a point is computed at once.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "shade/lights/light_bound.h"
#include "shade/lights/light_node.h"

namespace granita {

class LightTree {
  public:
    static constexpr std::uint32_t kWidth = LightNode::kWidth;
    using Slot = std::uint32_t;  ///< a child: node * kWidth + which
    static constexpr Slot kNoSlot = ~0u;

    /// Numbers the lamps anew, so that neighbours are near each other: lamp i here is `order`[i] of
    /// those that were given.
    LightTree(const std::vector<LightBound>& lamps, std::vector<std::uint32_t>& order,
              const Progress* progress = nullptr);

    std::size_t node_count() const { return m_nodes.size(); }
    std::size_t bytes() const;
    bool is_lamp(Slot slot) const { return (child(slot) & kLamp) != 0; }
    std::uint32_t lamp(Slot slot) const { return child(slot) & ~kLamp; }
    std::uint32_t node(Slot slot) const { return child(slot); }
    Slot slot_of_lamp(std::uint32_t lamp) const { return m_slot_of_lamp[lamp]; }
    bool is_face(std::uint32_t lamp) const { return m_is_face[lamp]; }
    /// kNoSlot of the root, which is node 0.
    Slot slot_of_node(std::uint32_t node) const { return m_slot_of_node[node]; }

    /// How much light that the lobes reflect each child of a node may give; 0 only where none can.
    /// `receives`: Instance::receives.  Returns their sum.
    float importances(std::uint32_t node, const LightReceiverView& receiver, std::uint64_t receives,
                      float (&of_child)[kWidth]) const;

    /// Calls `met(lamp)` for lamps whose bound a ray from `p` passes, in the order of the tree.
    template <class Met>
    void meet(const Vec3f& p, const Vec3f& direction, const Met& met) const {
        meet_below(0, p, Vec3f(1.0f) / direction, met);
    }

  private:
    static constexpr std::uint32_t kLamp = LightNode::kLamp;

    std::uint32_t child(Slot slot) const { return m_nodes[slot / kWidth].child[slot % kWidth]; }
    std::uint32_t add_node(const std::vector<LightBound>& lamps, std::uint32_t* first,
                           std::uint32_t* last, Slot parent, const Progress* progress);
    void set_child(std::uint32_t node, std::uint32_t i, const LightBound& bound);

    template <class Met>
    void meet_below(std::uint32_t node, const Vec3f& p, const Vec3f& inverse,
                    const Met& met) const {
        for (std::uint32_t bits = light_boxes_passed(m_nodes[node], p, inverse); bits;
             bits &= bits - 1) {
            const std::uint32_t below = m_nodes[node].child[std::countr_zero(bits)];
            if ((below & kLamp) != 0)
                met(below & ~kLamp);
            else
                meet_below(below, p, inverse, met);
        }
    }

    std::vector<LightNode> m_nodes;
    std::vector<Slot> m_slot_of_lamp, m_slot_of_node;
    std::vector<bool> m_is_face;  ///< [lamps]
};

}  // namespace granita
