// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/report.h"
#include "scene/scene.h"
#include "shade/lights/light_pattern.h"
#include "shade/textures/texture.h"

namespace granita {

/// The nodes of the scene's lights, which are run for samples of them: LightPatterns::of_lights.
/// Scene, textures and report must outlive them.
std::vector<LampPattern> lamp_patterns(const Scene& scene, TextureStore& textures, Report& report);

}  // namespace granita
