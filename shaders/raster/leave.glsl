// SPDX-License-Identifier: GPL-3.0-or-later
// What a fragment leaves in the target, by OUTPUT (raster/grid_output.glsl).
//
// Peeling is on (depth, name): a fragment belongs to the next layer if it lies behind the last one,
// or at the same depth with a larger name.  So of coincident surfaces none is lost, which happens
// where depth alone decides (paper, 9.3.4; Everitt 2001).  Draws are in the order of names, and the
// depth test keeps the first of equal depths: the smallest name that is left.
#include "raster/grid_output.glsl"
#include "shared/raster_layout.h"

struct Fragment {
    float depth;
    uint corner;  // vertex that names the micropolygon
    uint grid;
    int layer;
    vec4 radiance, opacity;
};

#if OUTPUT == SURFACE
layout(location = 0) out uint seen;
#elif OUTPUT == RADIANCE
layout(location = 0) out vec4 seen;
#elif OUTPUT == LAYER_RADIANCE || OUTPUT == LAYER_OPACITY
layout(binding = RASTER_LAYER_NAME) uniform usampler2DArray layer_name;
layout(binding = RASTER_LAYER_DEPTH) uniform sampler2DArray layer_depth;
layout(location = 0) out vec4 seen;
#elif OUTPUT == LAYER || OUTPUT == LAYER_NAME
layout(binding = RASTER_OPAQUE_DEPTH) uniform sampler2DArray opaque_depth;
layout(binding = RASTER_PEELED_DEPTH) uniform sampler2DArray peeled_depth;
layout(binding = RASTER_PEELED_NAME) uniform usampler2DArray peeled_name;
#if OUTPUT == LAYER
layout(location = 0) out vec4 seen_radiance;
layout(location = 1) out vec4 seen_opacity;
layout(location = 2) out uint seen_name;
layout(location = 3) out float seen_depth;
#else
layout(location = 0) out uint seen_name;
#endif
#else
layout(binding = RASTER_OPAQUE_DEPTH) uniform sampler2DArray opaque_depth;
#include "raster/marks.glsl"
#endif

void leave(Fragment f) {
#if OUTPUT == SURFACE
    seen = f.corner + 1u;
#elif OUTPUT == RADIANCE
    seen = f.radiance;
#elif OUTPUT == LAYER_RADIANCE || OUTPUT == LAYER_OPACITY
    // Only what the pass before has found: the depth too, for micropolygons that fold over themselves.
    const ivec3 at = ivec3(ivec2(gl_FragCoord.xy), f.layer);
    if (texelFetch(layer_name, at, 0).r != f.corner + 1u) discard;
    if (texelFetch(layer_depth, at, 0).r != f.depth) discard;
#if OUTPUT == LAYER_RADIANCE
    seen = f.radiance;
#else
    seen = f.opacity;
#endif
#elif OUTPUT == LAYER || OUTPUT == LAYER_NAME
    const ivec3 at = ivec3(ivec2(gl_FragCoord.xy), f.layer);
    const uint name = f.corner + 1u;
    const float last = texelFetch(peeled_depth, at, 0).r;
    if (f.depth > last || f.depth <= texelFetch(opaque_depth, at, 0).r) discard;
    if (f.depth == last && name <= texelFetch(peeled_name, at, 0).r) discard;
    seen_name = name;
#if OUTPUT == LAYER
    seen_radiance = f.radiance;
    seen_opacity = f.opacity;
    seen_depth = f.depth;
#else
    gl_FragDepth = f.depth;  // read again as what was compared
#endif
#else
    const ivec3 at = ivec3(ivec2(gl_FragCoord.xy), f.layer);
    if (f.depth > texelFetch(opaque_depth, at, 0).r) mark(f.grid, uint(f.layer));
#endif
}
