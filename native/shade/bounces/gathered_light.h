// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "dice/grid.h"
#include "math/vec.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/reflection.h"

namespace granita {

/// What other surfaces send to points and these towards the view, each [points].
struct GatheredLight {
    std::vector<Vec3f> diffuse;      ///< that diffuse lobes reflect
    std::vector<Vec3f> glossy;       ///< that others do, but for
    std::vector<Vec3f> mirrored;     ///< what mirrors alone bring, which is in no doubt
    std::vector<Vec3f> transmitted;  ///< of these two, what goes through
    /// Mean of 1 / distance of what these meet: how fast its light changes from place to place.
    std::vector<float> nearness;

    explicit GatheredLight(std::size_t points)
        : diffuse(points, Vec3f(0.0f)),
          glossy(points, Vec3f(0.0f)),
          mirrored(points, Vec3f(0.0f)),
          transmitted(points, Vec3f(0.0f)),
          nearness(points, 0.0f) {}
};

/// [points] what diffuse lobes gathered, `diffuse`, by albedo, shared between neighbours of a grid:
/// light of other surfaces, and of the world between them, varies as slowly as these are far away
/// (Ward, Rubinstein and Clear 1988, their error bound read the other way).
std::vector<Vec3f> shared_light(const ShadingPoints& points, const SurfaceClosure& closure,
                                const std::vector<Vec3f>& diffuse,
                                const std::vector<float>& nearness);

/// Adds what is reflected of `light`, and of what `grid` has gathered, to `radiance` [points] and,
/// where they are asked for, to its `parts`.
void reflect_gathered(const GatheredLight& light, const Grid& grid, const SurfaceClosure& closure,
                      ReflectionParts* parts, std::vector<Vec3f>& radiance);

}  // namespace granita
