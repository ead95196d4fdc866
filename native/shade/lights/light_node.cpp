// SPDX-License-Identifier: GPL-3.0-or-later
// The children of a node of the light tree, side by side.  Products and sums are rounded alone,
// whatever the width: the bits are those of every processor.
#include "shade/lights/light_node.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/lights/light_node.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, LightNode::kWidth>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;

HWY_INLINE V set(float value) {
    return hn::Set(kTag, value);
}

/// Angles in [0, pi].
struct Angle {
    V cos, sin;
};

HWY_INLINE Angle angle_of(V cosine) {
    return {cosine, hn::Sqrt(hn::Max(hn::Zero(kTag), set(1.0f) - cosine * cosine))};
}

/// a - b, 0 where b is more.
HWY_INLINE V cos_less(const Angle& a, const Angle& b) {
    return hn::IfThenElse(hn::Ge(a.cos, b.cos), set(1.0f), a.cos * b.cos + a.sin * b.sin);
}
HWY_INLINE Angle less(const Angle& a, const Angle& b) {
    const auto some = hn::Lt(a.cos, b.cos);
    return {cos_less(a, b), hn::IfThenElseZero(some, a.sin * b.cos - a.cos * b.sin)};
}

/// Children as they are seen from a point.
struct Seen {
    V to[3];  ///< unit, to their centers
    Angle size;

    /// Of the least angle from a cone.
    HWY_INLINE V cos_to(const DirectionCone& cone) const {
        const Vec3f& v = cone.axis;
        const V cosine = to[0] * set(v.x) + to[1] * set(v.y) + to[2] * set(v.z);
        return cos_less(less(angle_of(cosine), size), {set(cone.cos), set(cone.sin)});
    }
};

HWY_INLINE V reflected(const LobeReach& lobe, const Seen& seen) {
    const V above = seen.cos_to(lobe.normal);
    const auto any = hn::Gt(above, set(-kLightSlack));
    if (!lobe.glossy)
        return hn::IfThenElseZero(any, hn::Max(above, set(kLeastLightCosine)) * set(lobe.scale));
    const V cosine = seen.cos_to(lobe.mirrored);
    const V sin2 = set(0.5f) * hn::Max(hn::Zero(kTag), set(1.0f) - cosine);
    const V t = sin2 + set(lobe.alpha2) * (set(1.0f) - sin2);
    return hn::IfThenElseZero(any, set(lobe.scale) / (lobe.long_tail ? t : t * t));
}

void importances(const LightNode& node, const LightReceiverView& receiver, float* of_child) {
    for (std::size_t i = 0; i < LightNode::kWidth; i += hn::Lanes(kTag)) {
        const auto column = [i](const float* values) { return hn::Load(kTag, values + i); };
        Seen seen;
        V d2 = column(node.near2) + set(1e-20f), c2 = set(1e-30f);
        for (int k = 0; k < 3; ++k) {
            const V below = column(node.lo[k]) - set(receiver.hi[k]);
            const V above = set(receiver.lo[k]) - column(node.hi[k]);
            const V gap = hn::Max(hn::Zero(kTag), hn::Max(below, above));
            d2 = d2 + gap * gap;
            seen.to[k] = column(node.center[k]) - set(receiver.middle[k]);
            c2 = c2 + seen.to[k] * seen.to[k];
        }
        const V inverse = set(1.0f) / hn::Sqrt(c2);
        for (V& along : seen.to) along = along * inverse;
        const V sine = (column(node.radius) + set(receiver.radius)) * inverse;
        const auto inside = hn::Ge(sine, set(1.0f));
        const V cosine = hn::Sqrt(hn::Max(hn::Zero(kTag), set(1.0f) - sine * sine));
        seen.size.cos = hn::IfThenElse(inside, set(-1.0f), cosine);
        seen.size.sin = hn::IfThenElse(inside, hn::Zero(kTag), sine);
        const V cos_axis =
            hn::Neg(column(node.axis[0]) * seen.to[0] + column(node.axis[1]) * seen.to[1] +
                    column(node.axis[2]) * seen.to[2]);
        const Angle cone{column(node.cos_cone), column(node.sin_cone)};
        const V past = cos_less(less(angle_of(cos_axis), cone), seen.size);
        const V arriving = hn::IfThenElseZero(hn::Ge(past, column(node.cos_fall)),
                                              hn::Max(past, set(kLeastLightCosine)) / d2);
        V diffuse = hn::Zero(kTag), glossy = hn::Zero(kTag);
        for (std::size_t l = 0; l < receiver.lobe_count; ++l) {
            const LobeReach& lobe = receiver.lobes[l];
            V& sum = lobe.glossy_light ? glossy : diffuse;
            sum = sum + reflected(lobe, seen);
        }
        const V all = arriving * (column(node.diffuse) * diffuse + column(node.glossy) * glossy);
        // Sums of many of these are still numbers.
        hn::StoreU(hn::Min(all, set(1e30f)), kTag, of_child + i);
    }
}

/// Bits of those whose box a line's half passes: slabs.
std::uint32_t passed(const LightNode& node, const float* p, const float* inverse) {
    // A few roundings of slab distances.
    constexpr float kWider = 1.0f + 8.0f * std::numeric_limits<float>::epsilon();
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < LightNode::kWidth; i += hn::Lanes(kTag)) {
        V enter = hn::Zero(kTag), leave = hn::Inf(kTag);
        for (int k = 0; k < 3; ++k) {
            const V a = (hn::Load(kTag, node.lo[k] + i) - set(p[k])) * set(inverse[k]);
            const V b = (hn::Load(kTag, node.hi[k] + i) - set(p[k])) * set(inverse[k]);
            // Along a face of the box 0 * inf is no number: it is inside.
            const auto tells = hn::And(hn::Eq(a, a), hn::Eq(b, b));
            enter = hn::IfThenElse(tells, hn::Max(enter, hn::Min(a, b)), enter);
            leave = hn::IfThenElse(tells, hn::Min(leave, hn::Max(a, b)), leave);
        }
        std::uint8_t of_lanes[8] = {};
        hn::StoreMaskBits(kTag, hn::Le(enter, leave * set(kWider)), of_lanes);
        bits |= static_cast<std::uint32_t>(of_lanes[0]) << i;
    }
    return bits & ((1u << node.count) - 1u);
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(importances);
HWY_EXPORT(passed);

std::uint32_t light_boxes_passed(const LightNode& node, const Vec3f& p, const Vec3f& inverse) {
    return HWY_DYNAMIC_DISPATCH(passed)(node, &p.x, &inverse.x);
}

void light_importances(const LightNode& node, const LightReceiverView& receiver,
                       float (&of_child)[LightNode::kWidth]) {
    HWY_DYNAMIC_DISPATCH(importances)(node, receiver, of_child);
}

}  // namespace granita
#endif
