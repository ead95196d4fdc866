// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/gathered_light.h"

#include <cmath>

#include "shade/bounces/neighbours.h"

namespace granita {
namespace {

/// How far neighbours share, of the harmonic mean distance of other surfaces.
constexpr float kNear = 0.25f;
/// In steps of the grid: what varies faster than this is not drawn any more.
constexpr float kLeastReach = 2.0f;
/// Least albedo by which light is told.
constexpr float kLeastAlbedo = 1e-4f;

}  // namespace

Vec3f diffuse_albedo(const SurfaceClosure& closure, std::size_t point) {
    Vec3f sum(0.0f);
    for (const Lobe& lobe : closure.lobes)
        if (part_of(lobe.kind) == LightPart::Diffuse) sum += lobe.weight[point];
    return glm::max(sum, Vec3f(kLeastAlbedo));
}

std::vector<Vec3f> shared_light(const ShadingPoints& points, const SurfaceClosure& closure,
                                const GatheredLight& light) {
    NoisyValues noisy{light.diffuse, light.nearness, light.asked, kLeastReach};
    for (std::size_t i = 0; i < points.count; ++i) {
        noisy.values[i] /= diffuse_albedo(closure, i);
        noisy.by_reach[i] /= kNear;
    }
    return share(points, noisy);
}

}  // namespace granita
