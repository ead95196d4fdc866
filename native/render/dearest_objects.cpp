// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/dearest_objects.h"

#include <algorithm>
#include <unordered_map>

namespace granita {

std::vector<DearObject> dearest_objects(const Scene& scene, const ObjectCosts& costs,
                                        std::size_t most) {
    std::unordered_map<std::string, DearObject> by_name;
    for (std::size_t i = 0; i < costs.count(); ++i) {
        if (costs.seconds(i) == 0.0) continue;
        DearObject& object = by_name[scene.instances[i].name];
        object.seconds += costs.seconds(i);
        object.micropolygons += costs.micropolygons(i);
    }
    std::vector<DearObject> objects;
    for (auto& [name, object] : by_name) {
        object.name = name;
        objects.push_back(std::move(object));
    }
    std::ranges::sort(objects, [](const DearObject& a, const DearObject& b) {
        return a.seconds != b.seconds ? a.seconds > b.seconds : a.name < b.name;
    });
    objects.resize(std::min(objects.size(), most));
    return objects;
}

}  // namespace granita
