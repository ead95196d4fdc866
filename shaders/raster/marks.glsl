// SPDX-License-Identifier: GPL-3.0-or-later
// The grids that samples see, a bit a pass: [grids][words].
#include "shared/raster_layout.h"

layout(std430, binding = RASTER_SEEN) buffer Seen { uint seen[]; };
layout(location = RASTER_MARKED) uniform uvec2 marked;  // first pass of the draw, words a grid

void mark(uint grid, uint layer) {
    const uint pass = marked.x + layer, word = grid * marked.y + (pass >> 5), bit = 1u << (pass & 31u);
    // Most samples see what a neighbour has marked: reading spares the atomic.
    if ((seen[word] & bit) == 0u) atomicOr(seen[word], bit);
}
