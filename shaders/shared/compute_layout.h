// SPDX-License-Identifier: GPL-3.0-or-later
// Bindings and uniforms of the compute executor, for C++ and GLSL.
#ifndef GRANITA_COMPUTE_LAYOUT_H
#define GRANITA_COMPUTE_LAYOUT_H

// Storage buffers: 8 at once are guaranteed (OpenGL 4.5, table 23.64).
#define COMPUTE_BLOCKS 0
#define COMPUTE_ENTRIES 1
#define COMPUTE_VERTICES 2
#define COMPUTE_SAMPLES 3
#define COMPUTE_SEEN 4
#define COMPUTE_GRIDS 5
#define COMPUTE_COUNTS 6
#define COMPUTE_OUTPUT 7

#define COMPUTE_SAMPLES_A_PIXEL 0
#define COMPUTE_SAMPLE_STRIDE 1
#define COMPUTE_TIME_AT 2
#define COMPUTE_LENS_AT 3
#define COMPUTE_GRID_COUNT 4
#define COMPUTE_PERSPECTIVE 5
#define COMPUTE_KEY_RANGE 6
#define COMPUTE_BLOCK_COUNT 7

#define COMPUTE_PASS_OPAQUE 0
#define COMPUTE_PASS_COUNT 1
#define COMPUTE_PASS_FILL 2

// Samples that one workgroup owns.
#define COMPUTE_GROUP_SIZE 64

#endif
