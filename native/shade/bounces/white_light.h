// SPDX-License-Identifier: GPL-3.0-or-later
// Cycles' Fast GI, Add: white light around everything, hidden by what is near.
#pragma once

#include <span>
#include <vector>

#include "scene/options.h"
#include "shade/bounces/bounced_path.h"
#include "shade/rays/ray_scene.h"

namespace granita {

/// [ways] what of it diffuse lobes send along each, as far as things and media let it through as
/// they do with shadows; nothing of ways that have passed a surface: it was brought before that.
/// `rays`: the ways' own.
std::vector<Vec3f> white_light(const RayScene& scene, std::span<const BouncedPath> ways,
                               std::span<const Ray> rays, const Bounces& limits);

}  // namespace granita
