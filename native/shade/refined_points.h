// SPDX-License-Identifier: GPL-3.0-or-later
// Shading points between the vertices of a grid, each at a time of the shutter: what a sample sees
// is shaded there and then, where the mean over the shutter at the corners does not tell it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "dice/grid.h"
#include "scene/scene.h"
#include "shade/moving_eye.h"
#include "shade/programs/program.h"
#include "shade/shading_points.h"

namespace granita {

/// What is seen alike throughout the shutter is lit best by the mean over it.
inline constexpr float kAnyTime = -1.0f;

/// A place in a micropolygon.
struct RefinedPoint {
    std::uint32_t vertex[3];
    float weight[3];
    float time;           ///< of the shutter; kAnyTime: lit over all of it
    std::uint32_t place;  ///< in the sample sequences of the frame
};

/// [vertices] at a point.
inline Vec3f between(const std::vector<Vec3f>& values, const RefinedPoint& at) {
    Vec3f sum(0.0f);
    for (std::size_t k = 0; k < 3; ++k) sum += at.weight[k] * values[at.vertex[k]];
    return sum;
}

/// Light samples of such a point for each of a grid's: corners have those of their neighbours too,
/// which interpolation averages.
/// @param area that it stands for, in micropolygons.
inline float refined_light_fraction(float area) {
    return std::min(1.0f, 2.0f * area);
}

/// [wanted][width] of `values` [points][width] of the grid.
std::vector<float> blended_at(const Grid& grid, std::span<const RefinedPoint> wanted,
                              std::span<const float> values, int width);

struct RefinedPoints {
    ShadingPoints points;  ///< their times are set only where `timed`
    std::vector<GridAttribute> attributes;
    std::vector<ObjectAxes> axes_at_times;  ///< as those of ShadingInput
    GridLight found;                        ///< of the grid's

    /// @param grid with its shading state, whose points do not stand for faces.
    /// @param eye the camera's.
    /// @param timed whether anything of the frame moves.
    /// @param point_size side of the square that a point stands for, in steps of the grid.
    RefinedPoints(const Grid& grid, const Scene& scene, const ShadingCamera& camera,
                  const MovingEye& eye, std::span<const RefinedPoint> wanted, bool timed,
                  float point_size);

    /// painted_points(), with their attributes.
    RefinedPoints(const Grid& grid, std::span<const RefinedPoint> wanted);
};

}  // namespace granita
