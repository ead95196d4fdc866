// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"
#include "shade/bsdf/bsdf.h"
#include "shade/rays/ray.h"

namespace granita {

/// What a ray brings of the world if it meets nothing: the part that the world's own samples do not
/// tell.
struct WorldAhead {
    BsdfValue radiance{};  ///< as far as it is known, that parts of the ray's weight reflect
    /// How much more of what the world says along the ray: that diffuse lobes reflect, and others.
    float asked_by_diffuse = 0.0f, asked_by_others = 0.0f;
    float sign = 0.0f;  ///< as LitGrid::sign

    bool asks() const { return asked_by_diffuse > 0.0f || asked_by_others > 0.0f; }
    bool shines() const { return asks() || total(radiance) != Vec3f(0.0f); }
};

/// A way from which a lobe of a point would reflect light: towards other surfaces.
struct LobeRay {
    Ray ray;
    Vec3f weight{0.0f};  ///< reflected radiance per radiance that comes along it
    /// Of the weight, what its point's diffuse lobes reflect, and what goes through: parts of each
    /// channel.
    Vec3f diffuse{0.0f}, transmitted{0.0f};
    float share = 1.0f;              ///< of all ways of its point: how likely chance takes it
    float pdf = 0.0f;                ///< of its direction, per solid angle; infinite for a mirror's
    std::uint32_t point = 0;         ///< in the grid, or batch
    std::uint32_t place = 0;         ///< in sequences of samples: neighbours' are neighbours
    int samples = 1;                 ///< of its lobe that it stands for: a mirror sends all one way
    float counts_as = 1.0f;          ///< light samples of its point, by its weight: of mirrors
    float width = 0.0f;              ///< that its point stands for, metres
    float spread = 0.0f;             ///< radians that it stands for
    std::uint64_t receives = ~0ULL;  ///< as Instance::receives of what it leaves
    WorldAhead world;
};

/// Light of a lamp that a sample of a point's lobes has met.
struct MetLight {
    std::uint32_t point;  ///< in the grid, or batch
    Vec3f light;
    /// How many times as much it were, had chance taken one sample of all lobes, which stands for
    /// all: Cycles holds that to its clamp.
    float whole;
};

/// Those of the points of a grid, or batch.
struct LeavingRays {
    std::vector<LobeRay> rays{};
    /// True: what lobes meet of lamps is left out of reflect() and told by itself, a point's in
    /// the order of its samples.
    bool tells_met = false;
    std::vector<MetLight> met{};
    /// False: what diffuse lobes reflect is known, and no part of it is looked for.
    bool diffuse = true;
    /// What diffuse lobes reflect of the world counts as what surfaces send: neighbours share it.
    bool takes_world = false;
    /// [points] the ways of these alone are wanted, and no other light; empty: all of all.
    std::vector<std::uint8_t> only{};
    /// What samples of lobes would find of the world goes along with their rays and is left out of
    /// reflect(): one ray tells whether anything is met, and what.
    bool carries_world() const { return diffuse || takes_world; }
};

}  // namespace granita
