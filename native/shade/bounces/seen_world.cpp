// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/seen_world.h"

namespace granita {
namespace {

/// A diffuse lobe's ray brings light to the gloss that it is mixed with as well: each is shown what
/// its own rays may see, whichever of them were sent.
const PartRays& types_of(RayType ray) {
    if (is_sharp(ray)) return kSharp;
    if (ray == RayType::Scattered) return kScattered;
    return goes_through(ray) ? kBlurredThrough : kBlurred;
}

/// @param seen what the world says along the ray, if it is asked.
BsdfValue reflected(const LobeRay& ray, const BsdfValue& seen) {
    BsdfValue light = ray.world.radiance;
    light += {ray.world.asked_by_diffuse * seen.diffuse, ray.world.asked_by_others * seen.glossy,
              ray.world.asked_by_others * seen.transmission};
    light.diffuse *= ray.diffuse;
    light.transmission *= ray.transmitted;
    light.glossy *= glm::max(Vec3f(1.0f) - ray.diffuse - ray.transmitted, Vec3f(0.0f));
    return light;
}

}  // namespace

std::vector<BsdfValue> seen_world(const DirectLight& direct, std::span<const BouncedPath> paths,
                                  std::span<const std::uint8_t> meets_nothing) {
    std::vector<BsdfValue> light(paths.size());
    std::vector<std::size_t> asking;
    std::vector<Vec3f> directions;
    std::vector<BsdfValue> seen;
    for (const PartRays* types : {&kBlurred, &kBlurredThrough, &kSharp, &kScattered}) {
        asking.clear();
        directions.clear();
        for (std::size_t i = 0; i < paths.size(); ++i) {
            const LobeRay& ray = paths[i].next;
            if (meets_nothing[i] == 0 || &types_of(ray.ray.type) != types) continue;
            if (!ray.world.asks()) {
                light[i] = reflected(ray, {});
                continue;
            }
            asking.push_back(i);
            directions.push_back(ray.ray.direction);
        }
        if (asking.empty()) continue;
        direct.world_radiance(directions, *types, seen);
        for (std::size_t k = 0; k < asking.size(); ++k)
            light[asking[k]] = reflected(paths[asking[k]].next, seen[k]);
    }
    return light;
}

}  // namespace granita
