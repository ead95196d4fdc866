// SPDX-License-Identifier: GPL-3.0-or-later
// Where sixteen samples meet the micropolygons that they see, and what they see there: compiled for
// every SIMD target and chosen at run time (Highway), with the same bits on all.
#pragma once

#include <cstdint>

#include "hider/resolve/surface_interpolator.h"
#include "hider/simd/simd_kernel.h"

namespace granita {

/// The plain cases among `kCount` samples from `first` on: samples strictly inside one triangle.
/// One micropolygon after another with all samples that see it, so that its corners and colours are
/// broadcast and nothing is gathered: neighbouring samples see few.
void locate_lanes(SurfaceInterpolator& surfaces, const TileSamples& samples, std::uint32_t first,
                  const SurfaceId* ids, SurfaceRun& out);

/// The same samples of all that see one coloured micropolygon, wherever in the tile they lie; each
/// lane has its own segment of the motion (SurfaceInterpolator::color_groups).
/// @param sorted SurfaceGroups::sorted(), with t where the surface moves; the group's from `begin`
/// on.
/// @param knots of all segments that the group's times lie in.
/// @param group their indices in the tile.
/// @param colors,done [samples of the tile].
void color_group(const SurfaceInterpolator& surfaces, const TileSamples& sorted, std::size_t begin,
                 const SurfaceRecord& surface, const SurfaceKnots& knots,
                 std::span<const std::int32_t> group, SampleColors& colors,
                 std::span<std::uint8_t> done);

}  // namespace granita
