// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "shade/bsdf/lobe_reach.h"

namespace granita {

/// A node of the light tree: columns over its children, whose bounds (light_bound.h) they are.
/// Those that are not there have no intensity.
struct alignas(64) LightNode {
    static constexpr std::uint32_t kWidth = 8;
    static constexpr std::uint32_t kLamp = 1u << 31;

    float lo[3][kWidth], hi[3][kWidth], center[3][kWidth], radius[kWidth];
    float axis[3][kWidth], cos_cone[kWidth], sin_cone[kWidth], cos_fall[kWidth];
    float near2[kWidth], diffuse[kWidth], glossy[kWidth];
    std::uint64_t sets[kWidth];
    std::uint32_t child[kWidth];  ///< a node, or a lamp and kLamp
    std::uint8_t count = 0;       ///< the first children are there
    bool linked = false;          ///< whether any lamp below lights only some
};

/// Boxes and lobes, as light_importances() reads them.
struct LightReceiverView {
    float lo[3], hi[3], middle[3], radius;
    const LobeReach* lobes;
    std::size_t lobe_count;
};

/// A cosine that rounding may take for less; and the least cosine of what is not ruled out.
inline constexpr float kLightSlack = 1e-4f, kLeastLightCosine = 1e-3f;

/// Bits of the children whose box a ray from `p` passes; `inverse` of its direction.
std::uint32_t light_boxes_passed(const LightNode& node, const Vec3f& p, const Vec3f& inverse);

/// How much light the children can give, whatever they are linked to.
void light_importances(const LightNode& node, const LightReceiverView& receiver,
                       float (&of_child)[LightNode::kWidth]);

}  // namespace granita
