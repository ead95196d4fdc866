// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/object_costs.h"
#include "scene/scene.h"

namespace granita {

struct DearObject {
    std::string name;  ///< of all its instances
    double seconds = 0.0;
    std::uint64_t micropolygons = 0;
    bool operator==(const DearObject&) const = default;
};

/// Those that took most seconds, dearest first; none that took nothing.
/// @param costs [Scene::instances]
std::vector<DearObject> dearest_objects(const Scene& scene, const ObjectCosts& costs,
                                        std::size_t most);

}  // namespace granita
