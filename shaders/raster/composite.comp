// SPDX-License-Identifier: GPL-3.0-or-later
// Puts a peeled layer under the layers so far (paper, 9.3.4), each colour channel by itself: the
// paper's spectral opacity through multiple targets.  The arithmetic is composite.h's:
// C += T c, O += a T, T -= a T.
//
// The opacity threshold is asked a sample and a layer at a time, so the result does not depend on
// how grids were batched, which the paper's does (its figure 9.5).
#include "shared/raster_layout.h"

layout(local_size_x = RASTER_GROUP, local_size_y = RASTER_GROUP) in;
layout(binding = 0) uniform sampler2DArray layer_radiance;
layout(binding = 1) uniform sampler2DArray layer_opacity;  // w: 1 for holdouts
layout(binding = 2) uniform usampler2DArray layer_name;
layout(binding = 3) uniform sampler2DArray layer_depth;
layout(binding = 0, rgba32f) uniform image2DArray color;         // w: covered by surfaces
layout(binding = 1, rgba32f) uniform image2DArray transmission;  // w: cut out by holdouts
layout(binding = 2, r32f) uniform writeonly image2DArray peeled_depth;
layout(binding = 3, r32ui) uniform writeonly uimage2DArray peeled_name;
layout(location = RASTER_TEXELS) uniform ivec4 texels;  // corner and size
layout(location = RASTER_THRESHOLD) uniform float threshold;

#include "raster/mean.glsl"

void main() {
    if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), texels.zw))) return;
    const ivec3 at = ivec3(gl_GlobalInvocationID) + ivec3(texels.xy, 0);
    const uint name = texelFetch(layer_name, at, 0).r;
    if (name == 0u) return;
    const vec4 opacity = texelFetch(layer_opacity, at, 0);
    vec4 through = imageLoad(transmission, at), sum = imageLoad(color, at);
    // max(a, 0) with the variable second: what is no number is clear.
    const vec3 covered = min(max(vec3(0.0), opacity.rgb), vec3(1.0)) * through.rgb;
    sum.rgb += through.rgb * texelFetch(layer_radiance, at, 0).rgb;
    through.rgb -= covered;
    const float mean = mean_of(covered);
    if (opacity.w > 0.5)
        through.w += mean;
    else
        sum.w += mean;
    imageStore(color, at, sum);
    imageStore(transmission, at, through);
    const float least = 1.0 - max(through.r, max(through.g, through.b));
    const bool saturated = threshold < 1.0 && least >= threshold;
    // No depth lies behind -1: nothing more is peeled here.
    imageStore(peeled_depth, at,
               vec4(saturated ? -1.0 : texelFetch(layer_depth, at, 0).r));
    imageStore(peeled_name, at, uvec4(name));
}
