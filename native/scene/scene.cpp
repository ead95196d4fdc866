// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.h"

#include <algorithm>
#include <tuple>

namespace granita {

bool Image::operator==(const Image& other) const {
    const auto rest = [](const Image& i) {
        return std::tie(i.name, i.path, i.alpha_mode, i.width, i.height, i.pixels, i.bytes);
    };
    return (space == other.space || *space == *other.space) && rest(*this) == rest(other);
}

bool Scene::moves() const {
    return camera.world_from_camera.size() > 1 || has_lifespans() ||
           std::any_of(instances.begin(), instances.end(), [&](const Instance& instance) {
               return instance.world_from_object.size() > 1 || geometry_of(instance).knots > 1;
           });
}

bool Scene::has_lifespans() const {
    return std::any_of(instances.begin(), instances.end(),
                       [](const Instance& instance) { return !instance.lifespan.is_whole(); });
}

}  // namespace granita
