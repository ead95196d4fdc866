// SPDX-License-Identifier: GPL-3.0-or-later
// Whether rays that leave surfaces are worth their cost: under limits of 0 (Max Bounces 0, which
// Cycles' users set for speed) they find only what shines without being a lamp.
#pragma once

#include <algorithm>

#include "scene/scene.h"
#include "shade/lights/lamp_faces.h"
#include "shade/nodes/material_emission.h"
#include "shade/volumes/volumes.h"

namespace granita {

inline bool meets_light(const Scene& scene, const LampFaces& lamps,
                        const MaterialEmission& emission) {
    const Bounces& limits = scene.options.bounces;
    if (limits.most == 0 || limits.goes_on() || Volumes::any(scene)) return limits.most > 0;
    const auto shines = [&](std::int32_t material) { return emission.any(material); };
    for (std::size_t i = 0; i < scene.instances.size(); ++i)
        if (!lamps.hold_all_of(i) && std::ranges::any_of(scene.instances[i].materials, shines))
            return true;
    return false;
}

}  // namespace granita
