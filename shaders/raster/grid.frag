// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample sees where all samples of a pass have one time and one lens point.  Defines as in
// grid.vert.
#include "raster/leave.glsl"

#if !PERSPECTIVE
// Orthographic depth keeps the precision of float z over any clip range only as a reciprocal.
layout(location = RASTER_NEAR) uniform float near_clip;
in float z_camera;
#endif
flat in uint corner;
flat in uint layer_here;
#if OUTPUT == MARK
flat in uint grid_here;
#endif
#if HAS_RADIANCE
in vec4 radiance_here;
#endif
#if HAS_OPACITY
in vec4 opacity_here;
#endif

void main() {
    Fragment f;
#if PERSPECTIVE
    f.depth = gl_FragCoord.z;
#else
    if (z_camera < near_clip) discard;
    f.depth = near_clip / z_camera;
    gl_FragDepth = f.depth;
#endif
    f.corner = corner;
    f.layer = int(layer_here);
#if OUTPUT == MARK
    f.grid = grid_here;
#endif
#if HAS_RADIANCE
    f.radiance = radiance_here;
#endif
#if HAS_OPACITY
    f.opacity = opacity_here;
#endif
    leave(f);
}
