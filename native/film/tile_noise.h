// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hider/sample_store.h"
#include "hider/samples/sample_table.h"

namespace granita {

/// How far a tile's pixels are in doubt, from what the two halves of their samples say: the root of
/// the mean square of half their difference, of displayed colour (math/displayed.h) and opacity, in
/// the worst of the tile's four quarters; pixels as a box filter has them.
///
/// The halves are nets of the sample sequence, as all samples are, so that a slope across a pixel
/// puts them apart no more than the whole.  Of independent samples this is the standard error; of
/// nets, whose errors fall faster, it is more than that (measured: 1.0 to 1.2 times).
float tile_noise(const TileSamples& samples, const SampleColors& colors);

}  // namespace granita
