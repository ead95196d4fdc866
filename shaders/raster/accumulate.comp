// SPDX-License-Identifier: GPL-3.0-or-later
// Adds the passes of one draw to the mean of the passes so far (paper, 9.3.5, listing 2): layers
// over opaque surfaces over the background.
//
// The running mean m += (x - m) / n leaves a sample that is the same in all passes exactly as it is:
// a cell where nothing moves takes one pass, and its bits are those of many.
//
// What it takes it leaves empty for the next draw: a clear of the colour, which goes the way of
// fragments, took long on a GPU that has few units to draw with (docs/decisions/gl.md).
//
// Defines: AT_SAMPLE 0 or 1: samples lie at the lattice, or anywhere; those of raster/lattice.glsl.
#include "raster/lattice.glsl"
#include "shared/raster_layout.h"
#if AT_SAMPLE
#include "raster/samples.glsl"
#endif

layout(local_size_x = RASTER_GROUP, local_size_y = RASTER_GROUP) in;
layout(binding = 1) uniform sampler2DArray color;
layout(binding = 2) uniform sampler2DArray transmission;
layout(binding = 3) uniform sampler2DArray peeled_depth;
layout(binding = 0, rgba32f) uniform image2D mean;
layout(binding = 1, rgba32f) uniform image2DArray opaque;  // w: 1 a surface, 0 a holdout, -1 nothing
// The world at the corners of pixels, row by row, pass by pass.
layout(std430, binding = RASTER_BACKGROUND) readonly buffer Background { vec4 corners[]; };
layout(location = RASTER_TEXELS) uniform ivec4 texels;             // corner and size
layout(location = RASTER_COUNT) uniform ivec2 passes;              // done, now
layout(location = RASTER_CELL_PIXEL) uniform ivec2 cell_pixel;     // of texel 0, from corners' first
layout(location = RASTER_BACKGROUND_SIZE) uniform ivec3 size;      // corners; 0: one colour
layout(location = RASTER_BACKGROUND_CONSTANT) uniform vec4 constant;
layout(location = RASTER_FLAGS) uniform ivec2 flags;               // layers were peeled; film transparent

#include "raster/mean.glsl"

vec4 background(ivec2 texel, int pass) {
    if (size.x == 0) return constant;
    vec2 f;
    ivec2 corner = cell_pixel + pixel_of(texel, f);
#if AT_SAMPLE
    f = place_in_pixel(texel);
#elif ROTATED
    corner = clamp(corner, ivec2(0), size.xy - 2);  // around the rotated cell nobody asks
#endif
    const int i = ((size.z > 1 ? pass : 0) * size.y + corner.y) * size.x + corner.x;
    return mix(mix(corners[i], corners[i + 1], f.x),
               mix(corners[i + size.x], corners[i + size.x + 1], f.x), f.y);
}

vec4 sample_color(ivec3 at, int pass) {
    vec4 under = imageLoad(opaque, at);
    imageStore(opaque, at, vec4(0.0, 0.0, 0.0, -1.0));
    if (flags.x == 0) return under.w < 0.0 ? background(at.xy, pass) : under;
    // Behind the end of a list is nothing: what is there may have been left out.
    if (texelFetch(peeled_depth, at, 0).r < 0.0)
        under = vec4(vec3(0.0), flags.y != 0 ? 0.0 : 1.0);
    else if (under.w < 0.0)
        under = background(at.xy, pass);
    const vec4 through = texelFetch(transmission, at, 0), over = texelFetch(color, at, 0);
    const float left = mean_of(through.rgb);
    const float alpha =
        flags.y != 0 ? over.w + left * under.w : 1.0 - through.w - left * (1.0 - under.w);
    return vec4(over.rgb + through.rgb * under.rgb, alpha);
}

void main() {
    if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), texels.zw))) return;
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + texels.xy;
    vec4 sum = passes.x == 0 ? vec4(0.0) : imageLoad(mean, at);
    for (int layer = 0; layer < passes.y; ++layer) {
        const int pass = passes.x + layer;
        sum += (sample_color(ivec3(at, layer), pass) - sum) / float(pass + 1);
    }
    imageStore(mean, at, sum);
}
