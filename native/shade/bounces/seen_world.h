// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shade/bounces/bounced_path.h"
#include "shade/bsdf/bsdf.h"
#include "shade/lights/direct_light.h"

namespace granita {

/// [paths] what the places that rays have left reflect of the world (WorldAhead), by what of them
/// reflects it, where the ray `meets_nothing`; elsewhere nothing.  The world is asked for many
/// directions at once.
std::vector<BsdfValue> seen_world(const DirectLight& direct, std::span<const BouncedPath> paths,
                                  std::span<const std::uint8_t> meets_nothing);

}  // namespace granita
