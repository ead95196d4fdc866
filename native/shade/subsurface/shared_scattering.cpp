// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/subsurface/shared_scattering.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "math/luminance.h"
#include "shade/bounces/neighbours.h"

namespace granita {
namespace {

/// How far neighbours share, of a lobe's radius.
constexpr float kShared = 1.0f;
constexpr float kLeastWeight = 1e-6f;
/// Steps to each side in which neighbours are looked for.
constexpr float kFarthest = 6.0f;

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

int ways_of_points(const ShadingPoints& points, const SurfaceClosure& closure, int most) {
    const Vec3f seen(luminance(Vec3f(1, 0, 0)), luminance(Vec3f(0, 1, 0)),
                     luminance(Vec3f(0, 0, 1)));
    float fewest = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < points.count; ++i) {
        const float step = std::sqrt(glm::length(points.dp_du[i]) * glm::length(points.dp_dv[i]));
        // What channels add to the noise of luminance, with and without neighbours.
        float shared = 0.0f, alone = 0.0f;
        const Vec3f weight = subsurface_weight(closure, i);
        for (int c = 0; c < 3; ++c) {
            const float by = by_reach(closure, i, c);
            if (by == 0.0f) continue;
            const float steps = std::min(1.0f / (by * step), kFarthest);
            const float noise = seen[c] * weight[c] * seen[c] * weight[c];
            alone += noise;
            shared += noise / std::max(1.0f, steps * steps);
        }
        if (alone > 0.0f) fewest = std::min(fewest, alone / shared);
    }
    if (!std::isfinite(fewest)) return most;
    const float wanted = static_cast<float>(most) / std::sqrt(fewest);
    return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(1.0f, wanted))));
}

std::vector<Vec3f> share_scattered(const ShadingPoints& points, const SurfaceClosure& closure,
                                   const std::vector<Vec3f>& light) {
    const std::size_t count = points.count;
    NoisyValues noisy{light, std::vector<float>(count), std::vector<std::uint8_t>(count)};
    for (std::size_t i = 0; i < count; ++i)
        noisy.values[i] /= glm::max(subsurface_weight(closure, i), Vec3f(kLeastWeight));
    std::vector<Vec3f> all(count);
    for (int c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < count; ++i) {
            noisy.by_reach[i] = by_reach(closure, i, c);
            noisy.known[i] = noisy.by_reach[i] > 0.0f;
        }
        const std::vector<Vec3f> shared = share(points, noisy);
        for (std::size_t i = 0; i < count; ++i) all[i][c] = shared[i][c];
    }
    return all;
}

}  // namespace granita
