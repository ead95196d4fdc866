// SPDX-License-Identifier: GPL-3.0-or-later
// The pixel filter over a rotated lattice, with its downsampling: every pixel has the same list of
// texels and weights.  Not separable: no two samples of a pixel share a row.
//
// Defines: those of raster/lattice.glsl.
#include "raster/lattice.glsl"
#include "shared/raster_layout.h"

struct Tap {
    ivec2 texel;  // from the pixel's first
    float weight;
    float unused;
};

layout(std430, binding = FILTER_TABLE) readonly buffer Taps { Tap taps[]; };
layout(binding = FILTER_SOURCE) uniform sampler2D source;
layout(location = FILTER_ORIGIN) uniform ivec2 origin;  // the cell's pixel of the target's (0, 0)
layout(location = 0) out vec4 filtered;

void main() {
    const ivec2 first = first_texel(origin + ivec2(gl_FragCoord.xy));
    vec4 sum = vec4(0.0);
    for (int i = 0; i < taps.length(); ++i)
        sum += taps[i].weight * texelFetch(source, first + taps[i].texel, 0);
    filtered = sum;
}
