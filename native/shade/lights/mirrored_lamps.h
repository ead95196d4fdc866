// SPDX-License-Identifier: GPL-3.0-or-later
// Highlights between the corners of micropolygons: that of a small lamp on a polished ball is far
// narrower than one, and hardly ever lies on a corner.  And those that pass by within the shutter.
#pragma once

#include <cstdint>
#include <vector>

#include "dice/grid.h"
#include "shade/bsdf/lobe.h"
#include "shade/lights/lamp_set.h"

namespace granita {

/// Marks micropolygons [micropolygons] between whose corners facets mirror or refract the view to a
/// lamp of few, or past it by no more than lamp and lobe are wide, where both are too narrow for
/// corners to tell.  Empty: there are none.
/// @param points of the grid, which shades each corner by itself.
/// @param receives Instance::receives.
std::vector<std::uint8_t> mirrored_lamps(const LampSet& set, std::uint64_t receives,
                                         const Grid& grid, const ShadingPoints& points,
                                         const SurfaceClosure& closure);

/// Whether there are lamps and lobes by which the others may be true.
bool may_mirror_lamps(const LampSet& set, std::uint64_t receives, const SurfaceClosure& closure);

/// Whether facets mirror or refract the view to a lamp of few at some times and not at others.
/// @param points samples of ShadingPoints::times, those of one place one after the other.
bool lamps_pass(const LampSet& set, std::uint64_t receives, const ShadingPoints& points,
                const SurfaceClosure& closure);

}  // namespace granita
