// SPDX-License-Identifier: GPL-3.0-or-later
// Depth is not filtered: the sample nearest to the pixel's centre, as film/ does it.  0 where it sees
// nothing.
//
// Defines: AT_SAMPLE 0 or 1: samples lie at the lattice, or anywhere; CENTER, ivec2: the lattice's
// texel; those of raster/lattice.glsl.
#include "raster/lattice.glsl"
#include "raster/samples.glsl"

layout(binding = 0) uniform usampler2DArray names;
layout(binding = 1) uniform sampler2DArray depths;
layout(location = FILTER_ORIGIN) uniform ivec2 origin;  // the source's pixel of the target's (0, 0)
layout(location = 0) out float depth;

void main() {
    const ivec2 first = first_texel(origin + ivec2(gl_FragCoord.xy));
    ivec2 nearest = first + CENTER;
#if AT_SAMPLE
    float least = 1e9;
    for (int s = 0; s < count.y; ++s) {
        const ivec2 texel = first + ivec2(s % LATTICE, s / LATTICE);
        const vec2 d = place_in_pixel(texel) - 0.5;
        if (dot(d, d) < least) {
            least = dot(d, d);
            nearest = texel;
        }
    }
#endif
    depth = texelFetch(names, ivec3(nearest, 0), 0).r != 0u
                ? texelFetch(depths, ivec3(nearest, 0), 0).r
                : 0.0;
}
