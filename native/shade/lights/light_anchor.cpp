// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_anchor.h"

#include <algorithm>
#include <functional>

namespace granita {
namespace {

/// Light of others is found by distances alone.
constexpr std::size_t kMost = 8;

}  // namespace

std::vector<LightAnchor> anchors_of(const std::vector<Lamp>& lamps) {
    std::vector<LightAnchor> anchors;
    for (const Lamp& lamp : lamps) {
        LightBound bound;
        if (!lamp.bound(bound) || bound.box.empty()) continue;
        const Vec3f half = 0.5f * (bound.box.hi - bound.box.lo);
        anchors.push_back({bound.box.lo + half, std::max(bound.diffuse, bound.glossy),
                           bound.near2 + glm::dot(half, half)});
    }
    std::ranges::stable_sort(anchors, std::greater<>(), &LightAnchor::intensity);
    if (anchors.size() > kMost) anchors.resize(kMost);
    return anchors;
}

}  // namespace granita
