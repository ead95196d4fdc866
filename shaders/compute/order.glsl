// SPDX-License-Identifier: GPL-3.0-or-later
// GridPool::before: which of two surfaces wins a tie in depth.
#include "shared/compute_layout.h"

const uint kNone = 0xffffffffu;

struct GridOrder {
    uint base;  // id of the grid's micropolygon 0; ascending
    uint key[4];
};
layout(std430, binding = COMPUTE_GRIDS) readonly buffer Grids { GridOrder grids[]; };
layout(location = COMPUTE_GRID_COUNT) uniform uint grid_count;

uint grid_of(uint id) {
    uint lo = 0u, hi = grid_count;  // base[lo] <= id < base[hi]
    while (hi - lo > 1u) {
        const uint middle = (lo + hi) / 2u;
        if (grids[middle].base <= id)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

bool comes_before(uint a, uint b) {
    const uint grid_a = grid_of(a), grid_b = grid_of(b);
    for (int k = 0; k < 4; ++k) {
        const uint key_a = grids[grid_a].key[k], key_b = grids[grid_b].key[k];
        if (key_a != key_b) return key_a < key_b;
    }
    return a - grids[grid_a].base < b - grids[grid_b].base;
}
