// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/subsurface/shared_scattering.h"

#include <algorithm>

#include "shade/bounces/neighbours.h"

namespace granita {
namespace {

/// How far neighbours share, of a lobe's radius.
constexpr float kShared = 1.0f;
constexpr float kLeastWeight = 1e-6f;

/// 1 / metres within which a channel varies little; 0 where nothing of it scatters.
float by_reach(const SurfaceClosure& closure, std::size_t point, int channel) {
    float nearest = 0.0f;
    for (const SubsurfaceLobe& lobe : closure.subsurface)
        if (lobe.weight[point][channel] != 0.0f)
            nearest = std::max(nearest, 1.0f / (kShared * lobe.radius[point][channel]));
    return nearest;
}

}  // namespace

Vec3f subsurface_weight(const SurfaceClosure& closure, std::size_t point) {
    Vec3f sum(0.0f);
    for (const SubsurfaceLobe& lobe : closure.subsurface) sum += lobe.weight[point];
    return sum;
}

std::vector<Vec3f> share_scattered(const ShadingPoints& points, const SurfaceClosure& closure,
                                   const std::vector<Vec3f>& light) {
    const std::size_t count = points.count;
    NoisyValues noisy{light, std::vector<Vec3f>(count), std::vector<Vec3f>(count)};
    for (std::size_t i = 0; i < count; ++i) {
        noisy.values[i] /= glm::max(subsurface_weight(closure, i), Vec3f(kLeastWeight));
        for (int c = 0; c < 3; ++c) noisy.by_reach[i][c] = by_reach(closure, i, c);
        noisy.told[i] = Vec3f(glm::greaterThan(noisy.by_reach[i], Vec3f(0.0f)));
    }
    return share(points, noisy);
}

}  // namespace granita
