// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample sees.  Defines as in grid.vert.
//
// Peeling is on (depth, name): a fragment belongs to the next layer if it lies behind the last one,
// or at the same depth with a larger name.  So of coincident surfaces none is lost, which happens
// where depth alone decides (paper, 9.3.4; Everitt 2001).  Draws are in the order of names, and the
// depth test keeps the first of equal depths: the smallest name that is left.
#include "raster/grid_output.glsl"
#include "shared/raster_layout.h"

#if !PERSPECTIVE
// Orthographic depth keeps the precision of float z over any clip range only as a reciprocal.
layout(location = RASTER_NEAR) uniform float near_clip;
in float z_camera;
#endif
flat in uint corner;
flat in uint layer_here;

#if OUTPUT == SURFACE
layout(location = 0) out uint seen;
#elif OUTPUT == RADIANCE
in vec4 radiance_here;
layout(location = 0) out vec4 seen;
#elif OUTPUT == LAYER
layout(binding = RASTER_OPAQUE_DEPTH) uniform sampler2DArray opaque_depth;
layout(binding = RASTER_PEELED_DEPTH) uniform sampler2DArray peeled_depth;
layout(binding = RASTER_PEELED_NAME) uniform usampler2DArray peeled_name;
in vec4 radiance_here;
in vec4 opacity_here;
layout(location = 0) out vec4 seen_radiance;
layout(location = 1) out vec4 seen_opacity;
layout(location = 2) out uint seen_name;
layout(location = 3) out float seen_depth;
#else
layout(binding = RASTER_OPAQUE_DEPTH) uniform sampler2DArray opaque_depth;
flat in uint grid_here;
layout(std430, binding = RASTER_SEEN) buffer Seen { uint seen[]; };
#endif

void main() {
#if PERSPECTIVE
    const float depth = gl_FragCoord.z;
#else
    if (z_camera < near_clip) discard;
    const float depth = near_clip / z_camera;
    gl_FragDepth = depth;
#endif
#if OUTPUT == SURFACE
    seen = corner + 1u;
#elif OUTPUT == RADIANCE
    seen = radiance_here;
#elif OUTPUT == LAYER
    const ivec3 at = ivec3(ivec2(gl_FragCoord.xy), int(layer_here));
    const uint name = corner + 1u;
    const float last = texelFetch(peeled_depth, at, 0).r;
    if (depth > last || depth <= texelFetch(opaque_depth, at, 0).r) discard;
    if (depth == last && name <= texelFetch(peeled_name, at, 0).r) discard;
    seen_radiance = radiance_here;
    seen_opacity = opacity_here;
    seen_name = name;
    seen_depth = depth;
#else
    const ivec3 at = ivec3(ivec2(gl_FragCoord.xy), int(layer_here));
    if (depth > texelFetch(opaque_depth, at, 0).r) seen[grid_here] = 1u;
#endif
}
