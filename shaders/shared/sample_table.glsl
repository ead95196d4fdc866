// SPDX-License-Identifier: GPL-3.0-or-later
// SampleTable on the device: the same bits as native/hider/samples/sample_table.cpp, which says what the
// dimensions and the blocks are.  Only integer arithmetic and exact conversions to float.
//
// Without the shutter's and the lens' warps: those are tables made on the CPU (decision 15).
#include "hider/samples/sample_bits.h"

const uint kX = 0u, kY = 1u, kT = 2u, kU = 3u, kV = 4u;

float fraction20(uint bits) { return float(bits >> 12) * (1.0 / 1048576.0); }
float fraction24(uint bits) { return float(bits >> 8) * (1.0 / 16777216.0); }

/// INDEPENDENT, dimension d of sample s of `samples` of a frame pixel, in [0, 1).  x and y are
/// relative to the pixel and keep 20 bits, t, u and v 24.
float independent_sample(ivec2 pixel, uint s, uint samples, uint table_seed, uint d) {
    const uvec2 block = uvec2(pixel >> 7);  // blocks of 128 pixels; shifts round down
    const uvec2 place = uvec2(pixel & 127);
    const uint seed = dimension_seed(block_seed(table_seed, block.x, block.y), d);
    const uint number = morton(place.x, place.y) * samples + s;
    const uint index = sequence_place(number, square_digits(samples));
    const uint bits = owen(sobol_reversed(index, d), seed);
    return d <= kY ? fraction20(bits) : fraction24(bits);
}

/// REGULAR: samples of a pixel in a pass; the lattice is rotated where passes are many.
uint regular_cells(uint side, bool rotated) { return side * side + (rotated ? 1u : 0u); }

/// REGULAR: the lattice's place of sample s relative to the pixel.
vec2 regular_place(uint s, uint side, bool rotated) {
    const uint cell = s % regular_cells(side, rotated), points = rotated ? side * side + 1u : side;
    const uint column = rotated ? cell : cell % side;
    const uint row = rotated ? rotated_row(cell, side) : cell / side;
    return vec2(uvec2(cell_center(column, points), cell_center(row, points))) * (1.0 / 1048576.0);
}

/// REGULAR: t, u, v of the pass of sample s, each in [0, 1].
vec3 regular_pass(uint s, uint cells, uint passes) {
    const uint pass = s / cells;
    return vec3(float(cell_center(pass, passes)) * (1.0 / 1048576.0), fraction24(reverse_bits(pass)),
                fraction24(reverse_bits(sobol_reversed(pass, 1u))));
}
