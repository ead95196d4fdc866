// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/gathered_light.h"

#include <cmath>
#include <utility>

#include "shade/bounces/neighbours.h"

namespace granita {
namespace {

/// How far neighbours share, of the harmonic mean distance of other surfaces.
constexpr float kNear = 0.25f;
/// In steps of the grid: what varies faster than this is not drawn any more.
constexpr float kLeastReach = 2.0f;
/// Least albedo by which light is told: of what a pure red surface gets only the red is known.
constexpr float kLeastAlbedo = 1e-4f;

/// Weight of a point's diffuse lobes.
Vec3f diffuse_albedo(const SurfaceClosure& closure, std::size_t point) {
    Vec3f sum(0.0f);
    for (const Lobe& lobe : closure.lobes)
        if (part_of(lobe.kind) == LightPart::Diffuse) sum += lobe.weight[point];
    return sum;
}

/// [points] `diffuse` by albedo, shared between neighbours.
std::vector<Vec3f> shared_light(const ShadingPoints& points, const SurfaceClosure& closure,
                                const std::vector<Vec3f>& diffuse,
                                const std::vector<float>& nearness) {
    NoisyValues noisy{diffuse, std::vector<Vec3f>(points.count), std::vector<Vec3f>(points.count),
                      kLeastReach};
    for (std::size_t i = 0; i < points.count; ++i) {
        const Vec3f albedo = diffuse_albedo(closure, i);
        noisy.told[i] = Vec3f(glm::greaterThan(albedo, Vec3f(kLeastAlbedo)));
        noisy.values[i] *= noisy.told[i] / glm::max(albedo, Vec3f(kLeastAlbedo));
        noisy.by_reach[i] = Vec3f(nearness[i] / kNear);
    }
    return share(points, noisy);
}

}  // namespace

void share_gathered(const ShadingPoints& points, const SurfaceClosure& closure, bool takes_world,
                    bool tells_world, GatheredLight& light, Grid& grid) {
    if (takes_world && !light.world.empty()) {
        std::vector<Vec3f> world;
        for (std::size_t i = 0; i < light.world.size(); ++i) {
            world.push_back(std::exchange(light.world[i].diffuse, Vec3f(0.0f)));
            light.diffuse[i] += world[i];
            light.world_balance[i].x = 0.0f;
        }
        if (tells_world) grid.gathered_world = shared_light(points, closure, world, light.nearness);
    }
    grid.gathered = shared_light(points, closure, light.diffuse, light.nearness);
}

void reflect_world(const GatheredLight& light, ReflectionParts* parts, std::vector<float>* noise,
                   std::vector<Vec3f>& radiance) {
    for (std::size_t i = 0; i < light.world.size(); ++i) {
        const BsdfValue& world = light.world[i];
        radiance[i] += total(world);
        if (noise) (*noise)[i] += light.world_balance[i].x + light.world_balance[i].y;
        if (!parts) continue;
        parts->diffuse[i] += world.diffuse;
        parts->glossy[i] += world.glossy;
        parts->transmission[i] += world.transmission;
    }
}

void reflect_gathered(const GatheredLight& light, const Grid& grid, const SurfaceClosure& closure,
                      ReflectionParts* parts, std::vector<Vec3f>& radiance) {
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        const Vec3f albedo = diffuse_albedo(closure, i);
        const Vec3f diffuse = grid.gathered[i] * albedo;
        const Vec3f others = light.glossy[i] + light.mirrored[i];
        if (parts) {
            // Planes are fitted to either: what lies on top of them is not less than nothing.
            const Vec3f of_world = grid.gathered_world.empty()
                                       ? Vec3f(0.0f)
                                       : glm::min(grid.gathered_world[i] * albedo, diffuse);
            parts->diffuse[i] += of_world;
            parts->diffuse_bounced[i] = diffuse - of_world;
            parts->glossy_bounced[i] = others - light.transmitted[i];
            parts->transmission_bounced[i] = light.transmitted[i];
        }
        radiance[i] += diffuse + others;
    }
}

}  // namespace granita
