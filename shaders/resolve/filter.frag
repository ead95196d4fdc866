// SPDX-License-Identifier: GPL-3.0-or-later
// One pass of the separable pixel filter with its downsampling (paper, 9.3.6).
//
// Defines: TAP_COUNT; TAP_FIRST, sub-sample of the first tap, 0 being the pixel's own lowest;
// LATTICE, sub-samples a pixel; AXIS, ivec2(1, 0) or ivec2(0, 1).
//
// Differs from the paper, which unrolls and has weights as constants: straight-line code of hundreds
// of taps takes drivers seconds to compile, and NVIDIA's links no program with 1,025 constants
// (docs/decisions/gl.md).
#include "shared/raster_layout.h"

layout(binding = FILTER_SOURCE) uniform sampler2D source;
// The source's texel of the target's texel (0, 0).
layout(location = FILTER_ORIGIN) uniform ivec2 origin;
layout(location = 0) out vec4 filtered;

layout(std430, binding = FILTER_TABLE) readonly buffer Weights { float weights[]; };

void main() {
    const ivec2 own = origin + ivec2(gl_FragCoord.xy) * (ivec2(1) + (LATTICE - 1) * AXIS);
    const ivec2 first = own + (TAP_FIRST) * AXIS;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < TAP_COUNT; ++i)
        sum += weights[i] * texelFetch(source, first + i * AXIS, 0);
    filtered = sum;
}
