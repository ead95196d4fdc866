// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shade/lights/light_split.h"

namespace granita {
namespace {

/// Nearer than this part of a bound's radius, light of what is in it grows no more in the
/// importance: where in it the lamps are, its children tell.
constexpr float kNearest = 0.1f;

}  // namespace

LightTree::LightTree(const std::vector<LightBound>& lamps, std::vector<std::uint32_t>& order,
                     const Progress* progress) {
    order.resize(lamps.size());
    std::iota(order.begin(), order.end(), 0u);
    add_node(lamps, order.data(), order.data() + order.size(), kNoSlot, progress);
}

std::size_t LightTree::bytes() const {
    return m_nodes.size() * sizeof(LightNode) +
           (m_slot_of_lamp.size() + m_slot_of_node.size()) * sizeof(Slot) + m_is_face.size() / 8;
}

std::uint32_t LightTree::add_node(const std::vector<LightBound>& lamps, std::uint32_t* first,
                                  std::uint32_t* last, Slot parent, const Progress* progress) {
    if (progress) progress->check();
    const auto index = static_cast<std::uint32_t>(m_nodes.size());
    m_nodes.emplace_back();
    m_slot_of_node.push_back(parent);
    const std::vector<LightGroup> groups = split_lights(lamps, first, last, kWidth);
    m_nodes[index].count = static_cast<std::uint8_t>(groups.size());
    for (std::uint32_t i = 0; i < groups.size(); ++i) {
        const LightGroup& group = groups[i];
        const Slot slot = index * kWidth + i;
        set_child(index, i, group.bound);
        if (group.last - group.first == 1) {
            // Groups come in the order of the range: so do lamps.
            m_nodes[index].child[i] = static_cast<std::uint32_t>(m_slot_of_lamp.size()) | kLamp;
            m_slot_of_lamp.push_back(slot);
            m_is_face.push_back(lamps[*group.first].is_face);
        } else {
            const std::uint32_t below = add_node(lamps, group.first, group.last, slot, progress);
            m_nodes[index].child[i] = below;
        }
    }
    return index;
}

void LightTree::set_child(std::uint32_t index, std::uint32_t i, const LightBound& bound) {
    LightNode& node = m_nodes[index];
    const Vec3f center = 0.5f * (bound.box.lo + bound.box.hi);
    node.radius[i] = 0.5f * glm::length(bound.box.hi - bound.box.lo);
    for (int k = 0; k < 3; ++k) {
        node.lo[k][i] = bound.box.lo[k];
        node.hi[k][i] = bound.box.hi[k];
        node.center[k][i] = center[k];
        node.axis[k][i] = bound.axis[k];
    }
    node.cos_cone[i] = std::cos(bound.cone);
    node.sin_cone[i] = std::max(0.0f, std::sin(bound.cone));
    node.cos_fall[i] = std::cos(std::min(bound.fall, 0.5f * kPi)) - kLightSlack;
    const float nearest = kNearest * node.radius[i];
    node.near2[i] = std::max(bound.near2, nearest * nearest);
    node.diffuse[i] = bound.diffuse;
    node.glossy[i] = bound.glossy;
    node.sets[i] = bound.sets;
    node.linked |= bound.sets != ~0ULL;
}

float LightTree::importances(std::uint32_t index, const LightReceiverView& receiver,
                             std::uint64_t receives, float (&of_child)[kWidth]) const {
    const LightNode& node = m_nodes[index];
    light_importances(node, receiver, of_child);
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
        if (node.linked && node.sets[i] != ~0ULL && (node.sets[i] & receives) == 0)
            of_child[i] = 0.0f;
        sum += of_child[i];
    }
    return sum;
}

}  // namespace granita
