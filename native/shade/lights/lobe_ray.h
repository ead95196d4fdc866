// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"
#include "shade/rays/ray.h"

namespace granita {

/// A way from which a lobe of a point would reflect light: towards other surfaces.
struct LobeRay {
    Ray ray;
    Vec3f weight{0.0f};  ///< reflected radiance per radiance that comes along it
    /// Of the weight, what its point's diffuse lobes reflect, and what goes through: parts of each
    /// channel.
    Vec3f diffuse{0.0f}, transmitted{0.0f};
    float share = 1.0f;              ///< of the samples of all its point's lobes: one of so many
    float pdf = 0.0f;                ///< of its direction, per solid angle; infinite for a mirror's
    std::uint32_t point = 0;         ///< in the grid, or batch
    std::uint32_t place = 0;         ///< in sequences of samples: neighbours' are neighbours
    float spread = 0.0f;             ///< radians that it stands for
    std::uint64_t receives = ~0ULL;  ///< as Instance::receives of what it leaves
};

/// Those of the points of a grid, or batch.
struct LeavingRays {
    std::vector<LobeRay> rays;
    /// False: what diffuse lobes reflect is known, and no part of it is looked for.
    bool diffuse = true;
    /// What samples of lobes find of the world and diffuse lobes reflect counts as what surfaces
    /// send: it is left out of reflect(), which fills `world` [points], unless it is known.
    bool takes_world = false;
    std::vector<Vec3f> world;
};

}  // namespace granita
