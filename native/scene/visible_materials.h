// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "scene/scene.h"

namespace granita {

/// Whether `is(material)` of any slot of an instance that the camera sees; without slots of -1.
template <class Is>
bool any_visible_material(const Scene& scene, Is is) {
    return std::ranges::any_of(scene.instances, [&is](const Instance& instance) {
        if (!instance.visible_camera) return false;
        return instance.materials.empty() ? is(-1) : std::ranges::any_of(instance.materials, is);
    });
}

}  // namespace granita
