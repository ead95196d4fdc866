// SPDX-License-Identifier: GPL-3.0-or-later
// One pass of the separable pixel filter with its downsampling (paper, 9.3.6): as straight-line code
// with the weights and offsets as constants.
//
// Defines: TAPS, a list of TAP(offset, weight); LATTICE, sub-samples a pixel; AXIS, ivec2(1, 0) for
// the pass along x, ivec2(0, 1) for the one along y.
#include "shared/raster_layout.h"

layout(binding = FILTER_SOURCE) uniform sampler2D source;
// The source's texel of the target's texel (0, 0).
layout(location = FILTER_ORIGIN) uniform ivec2 origin;
layout(location = 0) out vec4 filtered;

#define TAP(offset, weight) sum += weight * texelFetch(source, first + (offset) * AXIS, 0);

void main() {
    const ivec2 first = origin + ivec2(gl_FragCoord.xy) * (ivec2(1) + (LATTICE - 1) * AXIS);
    vec4 sum = vec4(0.0);
    TAPS
    filtered = sum;
}
