// SPDX-License-Identifier: GPL-3.0-or-later
// Light that is scattered at random inside of a mesh until it meets its surface again (Chiang, Kutz
// and Burley 2016).
#pragma once

#include <cstdint>

#include "shade/bsdf/scattering_medium.h"
#include "shade/rays/ray_scene.h"

namespace granita {

struct WalkStart {
    Vec3f p, direction;  ///< on the surface, and into it
    Vec3f normal;        ///< out of it
    /// Metres within which numbers do not tell a place from the surface: RayOffset's.
    float rounding = 0.0f;
    std::uint64_t seed = 0;
};

/// Multiplies `weight` by what the way brings; false where it ends inside.  `exit`: what it meets
/// last, from inside.
bool walk(const RayScene& rays, const RayScene::Body& body, ScatteringMedium medium,
          const WalkStart& start, Vec3f& weight, RayScene::Met& exit);

}  // namespace granita
