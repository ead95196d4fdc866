// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of a cell: a texel is a sample, a pixel a block of `lattice` x `lattice` texels, the
// last of which may have none.
#include "shared/raster_layout.h"

// x and y relative to the tile, t, 0; then, with a lens, what offset_lens wants.
layout(std430, binding = RASTER_SAMPLES) readonly buffer Samples { vec4 samples[]; };
layout(location = RASTER_SAMPLE_AREA) uniform ivec4 area;       // texels that have samples: corner, size
layout(location = RASTER_SAMPLE_CORNER) uniform ivec2 corner_pixel;  // of the frame, at texel (0, 0)
layout(location = RASTER_SAMPLE_COUNT) uniform ivec2 count;     // lattice, samples of a pixel

int index_of(ivec2 texel) { return (texel.y - area.y) * area.z + texel.x - area.x; }

bool has_sample(ivec2 texel) {
    const ivec2 cell = texel % count.x;
    return cell.y * count.x + cell.x < count.y;
}

vec4 sample_at(ivec2 texel) { return samples[index_of(texel)]; }

vec3 lens_at(ivec2 texel) { return samples[area.z * area.w + index_of(texel)].xyz; }

/// The tile of 16 pixels of the frame in which the texel lies; shifts round down.
ivec2 tile_of(ivec2 texel) { return (corner_pixel + texel / count.x) >> 4; }

/// Relative to the pixel's own lower-left corner.
vec2 place_in_pixel(ivec2 texel) {
    return sample_at(texel).xy - vec2((corner_pixel + texel / count.x) & 15);
}
