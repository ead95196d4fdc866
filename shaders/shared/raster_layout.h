// SPDX-License-Identifier: GPL-3.0-or-later
// What C++ and the shaders of the raster executor must agree on; compiled by both.
#ifndef GRANITA_RASTER_LAYOUT_H
#define GRANITA_RASTER_LAYOUT_H

// Vertex attributes; the layer is one an instance.
#define RASTER_GRID 0
#define RASTER_LAYER 1
#define RASTER_RADIANCE 2
#define RASTER_OPACITY 3

// Shader storage blocks.
#define RASTER_POSITIONS 0
#define RASTER_GRIDS 1
#define RASTER_PASSES 2
#define RASTER_SEEN 3
#define RASTER_BACKGROUND 4
#define RASTER_TRIANGLES 5
#define RASTER_VERTEX_GRIDS 6
#define RASTER_SAMPLES 7
// Of raster/sample.frag, which has neither passes nor a background.
#define RASTER_VERTEX_OPACITY 2
#define RASTER_VERTEX_RADIANCE 4

// Uniform locations of raster/grid.*.
#define RASTER_CLIP_SCALE 0
#define RASTER_CLIP_CENTER 1
#define RASTER_NEAR 2
#define RASTER_FIRST_PASS 3
#define RASTER_LATTICE_TURN 4
// Of raster/sample.*; 5 and 6 are those of compute/corner.glsl.
#define RASTER_INVERSE_FOCUS 7
#define RASTER_LENS_RADIUS 8
#define RASTER_CELL_SIZE 9
#define RASTER_RASTER_SCALE 10
#define RASTER_RASTER_CENTER 11
// Of raster/samples.glsl, wherever it is included.
#define RASTER_SAMPLE_AREA 12
#define RASTER_SAMPLE_CORNER 13
#define RASTER_SAMPLE_COUNT 14
// Of raster/marks.glsl and mark_seen.comp.
#define RASTER_MARKED 15
#define RASTER_HIDE_SATURATED 16

// Texture units of raster/grid.frag.
#define RASTER_OPAQUE_DEPTH 0
#define RASTER_PEELED_DEPTH 1
#define RASTER_PEELED_NAME 2
#define RASTER_LAYER_NAME 3
#define RASTER_LAYER_DEPTH 4

// Uniform locations of the compute shaders of raster/; work groups are squares of texels.
#define RASTER_GROUP 8
#define RASTER_TEXELS 0
#define RASTER_COUNT 1
#define RASTER_THRESHOLD 2
#define RASTER_CELL_PIXEL 3
#define RASTER_BACKGROUND_SIZE 4
#define RASTER_BACKGROUND_CONSTANT 5
#define RASTER_FLAGS 6

// Uniform locations, texture unit and storage block of the filters of resolve/.
#define FILTER_ORIGIN 0
#define FILTER_RADIUS 1
#define FILTER_SOURCE 0
#define FILTER_TABLE 0

#endif
