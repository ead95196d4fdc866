// SPDX-License-Identifier: GPL-3.0-or-later
// What C++ and the shaders of the raster executor must agree on; compiled by both.
#ifndef GRANITA_RASTER_LAYOUT_H
#define GRANITA_RASTER_LAYOUT_H

// Vertex attributes.
#define RASTER_POSITION 0
#define RASTER_RADIANCE 1

// Uniform locations of raster/grid.*.
#define RASTER_CLIP_SCALE 0
#define RASTER_CLIP_CENTER 1
#define RASTER_NEAR 2

// Uniform location and texture unit of resolve/filter.frag.
#define FILTER_ORIGIN 0
#define FILTER_SOURCE 0

#endif
