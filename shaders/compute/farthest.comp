// SPDX-License-Identifier: GPL-3.0-or-later
// The farthest key of each block of 4 x 4 pixels over all its samples, for the CPU's hierarchical
// depth (Greene, Kass and Miller 1993).  One invocation a block.
//
// Block::first is the set of the block's pixels that count, bit p for pixel p.
#include "compute/blocks.glsl"

layout(local_size_x = COMPUTE_GROUP_SIZE) in;

layout(std430, binding = COMPUTE_SEEN) readonly buffer Seen { uvec2 seen[]; };
layout(std430, binding = COMPUTE_OUTPUT) writeonly buffer Farthest { float farthest[]; };
layout(location = COMPUTE_BLOCK_COUNT) uniform uint block_count;

void main() {
    const uint b = gl_GlobalInvocationID.x;
    if (b >= block_count) return;
    const Block block = blocks[b];
    float least = uintBitsToFloat(0x7f800000u);
    for (uint p = 0u; p < 16u; ++p) {
        if ((block.first >> p & 1u) == 0u) continue;
        const uvec2 pixel = pixel_of(block, p);
        const uint i = (block.tile * 256u + pixel.y * 16u + pixel.x) * samples_a_pixel;
        for (uint s = 0u; s < samples_a_pixel; ++s)
            least = min(least, uintBitsToFloat(seen[i + s].x));
    }
    farthest[b] = least;
}
