// SPDX-License-Identifier: GPL-3.0-or-later
// One frame, complete and immutable: what Python hands over (docs/scene_snapshot.md).
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/camera.h"
#include "scene/color_space.h"
#include "scene/geometry_list.h"
#include "scene/lifespan.h"
#include "scene/light.h"
#include "scene/node_graph.h"
#include "scene/options.h"

namespace granita {

struct Instance {
    std::string name;
    int geometry = 0;
    std::vector<Mat4d> world_from_object;  ///< [K] equidistant knots; one = static
    std::vector<Mat4d> adjacent;           ///< as Camera::adjacent
    Lifespan lifespan;                     ///< when it exists; places are given throughout
    std::vector<std::int32_t>
        materials;  ///< [slots] index in Scene::materials, -1 = none (Blender's default grey)
    bool visible_camera = true;
    /// To rays from other surfaces, by what sends them.
    bool visible_diffuse = true, visible_glossy = true, visible_transmission = true;
    bool visible_volume = true;  ///< to rays from what fills things
    bool casts_shadow = true;
    bool holdout = false;
    /// Stands for what is in a plate: shows the background, darkened as what else there is darkens
    /// it.
    bool shadow_catcher = false;
    /// Cosine to smooth faces below which rays to lamps start above them (geometry/smooth_rise.h).
    float terminator_offset = 0.0f;
    int object_index = 0;  ///< pass_index
    float random = 0.0f;
    /// By sets of lights that are linked: those that light it, and those of which it casts shadows.
    std::uint64_t receives = ~0ULL, blocks = ~0ULL;
    int receiver_set = -1, blocker_set = -1;  ///< where it shines, as Light's
    std::uint32_t key = 0;  ///< rank of the persistent identity: orders micropolygons (decision 3)
    bool operator==(const Instance&) const = default;

    bool is_seen_by_light() const {
        return visible_diffuse || visible_glossy || visible_transmission || visible_volume;
    }
    /// Index in Scene::materials, -1 = none.  An element may keep the slot of a material that is
    /// gone: Blender takes the last one there is.
    std::int32_t material(std::int32_t slot) const {
        if (materials.empty()) return -1;
        const auto last = static_cast<std::int32_t>(materials.size()) - 1;
        return materials[static_cast<std::size_t>(std::clamp(slot, 0, last))];
    }
};

struct Scene {
    Options options;
    Camera camera;
    GeometryList geometries;
    std::vector<Instance> instances;
    /// Four numbers an instance that shaders ask for: the object's colour, attributes of objects.
    std::map<std::string, std::vector<Vec4f>> instance_values;
    std::vector<Material> materials;
    std::vector<Image> images;
    WorkingSpace working_space;
    std::vector<Light> lights;
    World world;
    std::uint64_t receives_in_volumes = ~0ULL;  ///< as Instance::receives, of what fills the world

    const GeometryData& geometry_of(const Instance& instance) const {
        return geometries[static_cast<std::size_t>(instance.geometry)];
    }
    /// Whether what has a material (-1 = none) of an instance cuts out of the picture.
    bool holds_out(const Instance& instance, int material) const {
        return instance.holdout || instance.shadow_catcher || is_holdout(material);
    }
    /// Whether it shows the background instead.  `index` of the instance.
    bool catches_shadows(std::size_t index, int material) const {
        const Instance& instance = instances[index];
        return instance.shadow_catcher && !instance.holdout && !is_holdout(material);
    }
    bool has_shadow_catchers() const {
        return std::ranges::any_of(instances, &Instance::shadow_catcher);
    }
    /// Whether camera or geometry has more than one knot, or something appears or vanishes.
    bool moves() const;
    /// Whether some instance does not exist throughout the shutter.
    bool has_lifespans() const;

  private:
    bool is_holdout(int material) const {
        return material >= 0 && materials[static_cast<std::size_t>(material)].holdout;
    }
};

}  // namespace granita
