// SPDX-License-Identifier: GPL-3.0-or-later
// One pass of the separable pixel filter with its downsampling, made for one filter: its weights are
// constants (paper, 9.3.6).
//
// Defines: TAP_WEIGHTS, a list of TAP_COUNT floats; TAP_FIRST, sub-sample of the first, 0 being the
// pixel's own lowest; LATTICE, sub-samples a pixel; AXIS, ivec2(1, 0) or ivec2(0, 1).
//
// Differs from the paper, which unrolls: drivers unroll what they see fit, and straight-line code of
// hundreds of taps takes them seconds to compile (docs/decisions/gl.md).
#include "shared/raster_layout.h"

layout(binding = FILTER_SOURCE) uniform sampler2D source;
// The source's texel of the target's texel (0, 0).
layout(location = FILTER_ORIGIN) uniform ivec2 origin;
layout(location = 0) out vec4 filtered;

const float kWeights[TAP_COUNT] = float[](TAP_WEIGHTS);

void main() {
    const ivec2 own = origin + ivec2(gl_FragCoord.xy) * (ivec2(1) + (LATTICE - 1) * AXIS);
    const ivec2 first = own + (TAP_FIRST) * AXIS;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < TAP_COUNT; ++i)
        sum += kWeights[i] * texelFetch(source, first + i * AXIS, 0);
    filtered = sum;
}
