// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks of 4 x 4 pixels, the unit of work of the compute executor.
#include "shared/compute_layout.h"

struct Block {
    uint tile;   // in the buffers of samples
    uint block;  // 0 to 15, row by row
    uint first;  // entries of its list
    uint count;
};
layout(std430, binding = COMPUTE_BLOCKS) readonly buffer Blocks { Block blocks[]; };
layout(location = COMPUTE_SAMPLES_A_PIXEL) uniform uint samples_a_pixel;

/// Pixel p of the block, relative to the tile.
uvec2 pixel_of(Block block, uint p) {
    return uvec2(block.block % 4u, block.block / 4u) * 4u + uvec2(p % 4u, p / 4u);
}
