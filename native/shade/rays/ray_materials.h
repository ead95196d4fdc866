// SPDX-License-Identifier: GPL-3.0-or-later
// What materials do to light, as rays ask them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "math/vec.h"
#include "scene/scene.h"
#include "shade/rays/ray.h"
#include "shade/rays/ray_hit.h"

namespace granita {

/// Called from any thread; any may be missing, of the first two both.
struct RayMaterials {
    /// To rays of some type.
    std::function<bool(std::int32_t material)> is_transparent;
    /// What passes the surface: 0 = opaque, 1 = nothing there.
    std::function<Vec3f(const RayHit&, RayType)> transparency;
    /// Whether it goes by attributes alone: such hits need neither frame nor normal.
    std::function<bool(std::int32_t material, RayType)> is_painted = nullptr;
    /// What passes of a material where it is one everywhere, to all types: places are then not
    /// looked up.
    std::function<std::optional<Vec3f>(std::int32_t material)> constant = nullptr;
    /// What it sends to all sides and from everywhere, so that its meshes are lamps; nullopt: they
    /// are, but it varies; 0: they are none.
    std::function<std::optional<Vec3f>(std::int32_t material)> emitted = nullptr;
    /// Whether its surfaces are met by rays of their own, to whatever else they are hidden: from
    /// inside, where light is scattered below them, or by nodes.
    std::function<bool(std::int32_t material)> is_met_by_itself = nullptr;
    /// What is there inside of its surfaces, and whether these are there themselves.
    enum class Inside { Nothing, Volume, VolumeAlone };
    std::function<Inside(std::int32_t material)> inside = nullptr;
    /// Multiplies what is left of the light of shadow rays by what passes the volumes on their way.
    std::function<void(std::span<const Ray>, std::span<Vec3f> left)> dim = nullptr;

    bool meets_itself(const Instance& instance) const {
        return is_met_by_itself && std::ranges::any_of(instance.materials, is_met_by_itself);
    }
    bool holds_volume(const Instance& instance) const {
        return inside && std::ranges::any_of(instance.materials, [this](std::int32_t material) {
                   return inside(material) != Inside::Nothing;
               });
    }
    /// Whether nothing of the instance is a surface.
    bool is_volume_alone(const Instance& instance) const {
        return inside && !instance.materials.empty() &&
               std::ranges::all_of(instance.materials, [this](std::int32_t material) {
                   return inside(material) == Inside::VolumeAlone;
               });
    }
    /// Whether meshes of the instance are lamps, and what rays leave the lamps light.
    bool shines(const Instance& instance) const {
        if (!emitted || !instance.is_seen_by_light()) return false;
        return std::ranges::any_of(instance.materials, [this](std::int32_t material) {
            return emitted(material) != Vec3f(0.0f);
        });
    }
};

}  // namespace granita
