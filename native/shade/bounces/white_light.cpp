// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/white_light.h"

namespace granita {

std::vector<Vec3f> white_light(const RayScene& scene, std::span<const BouncedPath> ways,
                               std::span<const Ray> rays, const Bounces& limits) {
    std::vector<std::size_t> asking;
    std::vector<Ray> asked;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        if (ways[i].length > 0.0f || ways[i].next.diffuse == Vec3f(0.0f)) continue;
        asking.push_back(i);
        asked.push_back(rays[i]);
        asked.back().type = RayType::Shadow;
        asked.back().distance = limits.occlusion_distance;
    }
    std::vector<Vec3f> left(asked.size(), Vec3f(1.0f));
    scene.transmittances(asked, left);
    std::vector<Vec3f> light(ways.size(), Vec3f(0.0f));
    for (std::size_t k = 0; k < asking.size(); ++k)
        light[asking[k]] = ways[asking[k]].next.diffuse * left[k] * limits.occlusion_added;
    return light;
}

}  // namespace granita
