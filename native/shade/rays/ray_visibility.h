// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/scene.h"
#include "shade/rays/ray_type.h"

namespace granita {

/// Whether such rays can meet the instance.  Diffuse and glossy mean what is reflected: whatever
/// goes through a surface is transmitted and nothing else, of translucent lobes too (Cycles).
inline bool meets(RayType ray, const Instance& instance) {
    if (ray == RayType::Camera) return instance.visible_camera;
    if (ray == RayType::Shadow) return instance.casts_shadow;
    if (ray == RayType::Scattered) return instance.visible_volume;
    if (goes_through(ray)) return instance.visible_transmission;
    return is_diffuse(ray) ? instance.visible_diffuse : instance.visible_glossy;
}

/// Whether there is no ray that it is hidden from.
inline bool meets_all(const Instance& instance) {
    return instance.visible_camera && instance.casts_shadow && instance.visible_diffuse &&
           instance.visible_glossy && instance.visible_transmission && instance.visible_volume;
}

/// Likewise; light of a set passes what does not block it.
inline bool meets(RayType ray, const Instance& instance, int blocker_set) {
    return meets(ray, instance) &&
           (ray != RayType::Shadow || in_light_set(instance.blocks, blocker_set));
}

}  // namespace granita
