// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_transforms.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>

#include "scene/knot_time.h"

namespace granita {
namespace {

/// Embree's own limit, and more than Blender can ask for (dice/knots.h).
constexpr std::size_t kMostKnots = RTC_MAX_TIME_STEP_COUNT;

/// Embree inverts transforms in single precision, and may abort at rays that come out infinite.
/// Below these it meets nothing.
constexpr double kLeastRelativeVolume = 1e-9, kLeastScale = 1e-12;

/// What passes through a transform without volume, or stays in it for a while, gets this much of
/// its size in all directions: below the offset of a ray's origin, and enough to invert it.
constexpr double kThickness = 0x1p-22;
/// Of no symmetry, so that no mirrored thing loses its volume at a round time.
const Mat3d kThickening(1.0, 0.37, -0.21, -0.43, 0.83, 0.29, 0.19, -0.31, 0.71);

double longest_edge(const Mat4d& m) {
    const auto length = [&](int c) { return glm::length(Vec3d(m[c])); };
    return std::max({length(0), length(1), length(2)});
}

/// Volume of a transform's unit cube, signed, over that of a cube of its longest edge; 0 where it
/// is too small to tell.
double relative_volume(const Mat4d& m) {
    const double longest = longest_edge(m);
    if (longest < kLeastScale) return 0.0;
    return glm::determinant(Mat3d(m)) / (longest * longest * longest);
}

enum class Volume { Always, AtTimes, Never };

Volume has_volume(const std::vector<Mat4d>& knots) {
    double least = 1.0, most = -1.0;
    const auto note = [&](const Mat4d& m) {
        const double volume = relative_volume(m);
        least = std::min(least, volume);
        most = std::max(most, volume);
    };
    for (std::size_t k = 0; k < knots.size(); ++k) {
        note(knots[k]);
        if (k > 0) note(0.5 * (knots[k - 1] + knots[k]));  // of half a turn nothing is left there
    }
    const bool turned_out = most >= kLeastRelativeVolume,
               turned_in = least <= -kLeastRelativeVolume;
    if (!turned_out && !turned_in) return Volume::Never;
    const bool all_out = least >= kLeastRelativeVolume, all_in = most <= -kLeastRelativeVolume;
    return all_out || all_in ? Volume::Always : Volume::AtTimes;
}

std::array<float, 12> column_major(const Mat4d& m) {
    std::array<float, 12> numbers;
    for (int i = 0; i < 12; ++i)
        numbers[static_cast<std::size_t>(i)] = static_cast<float>(m[i / 3][i % 3]);
    return numbers;
}

}  // namespace

std::optional<RayTransforms> ray_transforms(const std::vector<Mat4d>& world_from_object,
                                            const Vec3d& origin) {
    RayTransforms made{world_from_object, {}};
    // One knot where it stands still: Embree then needs no motion hierarchy for it.
    if (is_static(world_from_object)) made.knots.resize(1);
    if (made.knots.size() > kMostKnots) {
        made.knots.resize(kMostKnots);
        for (std::size_t k = 0; k < kMostKnots; ++k)
            made.knots[k] = matrix_at(world_from_object, static_cast<double>(k) / (kMostKnots - 1));
    }
    const Volume volume = has_volume(made.knots);
    if (volume == Volume::Never) return std::nullopt;
    for (const Mat4d& m : made.knots)
        made.scale = std::max(made.scale, static_cast<float>(longest_edge(m)));
    for (Mat4d& m : made.knots) {
        m[3] -= glm::dvec4(origin, 0.0);
        if (volume == Volume::AtTimes)
            for (int c = 0; c < 3; ++c)
                m[c] += glm::dvec4(kThickness * made.scale * kThickening[c], 0.0);
        made.distance = std::max(made.distance, static_cast<float>(glm::length(Vec3d(m[3]))));
        const auto& column = made.columns.emplace_back(column_major(m));
        if (!std::ranges::all_of(column, [](float f) { return std::isfinite(f); }))
            return std::nullopt;
    }
    return made;
}

}  // namespace granita
