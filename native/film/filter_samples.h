// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of a tile, weighed for every pixel whose filter reaches them.  Compiled for every
// SIMD target and chosen at run time (Highway); all targets give the same bits: a lane is a pixel
// of a row, and its samples are summed one after another.
#pragma once

#include "film/filter_pieces.h"
#include "film/tile_sums.h"
#include "hider/sample_store.h"

namespace granita {

/// Adds to `sums` all samples of the rows [y0, y1) of the tile.  The weight of a sample is the
/// product of its two factors and one over the samples of a pixel.
/// @param channels [256 * samples][sums.width], then SampleChannels::kPadding; nullptr where none.
void filter_samples(const FilterPieces& filter, const TileSamples& samples,
                    const SampleColors& colors, const float* channels, int y0, int y1,
                    TileSums& sums);

}  // namespace granita
