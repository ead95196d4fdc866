// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample sees where all samples of a pass have one time and one lens point.  Defines as in
// grid.vert.
#include "raster/leave.glsl"

#if !PERSPECTIVE
// Orthographic depth keeps the precision of float z over any clip range only as a reciprocal.
layout(location = RASTER_NEAR) uniform float near_clip;
in float z_camera;
flat in float z_corner;
#endif
flat in uint corner;
flat in uint layer_here;
#if OUTPUT == MARK
flat in uint grid_here;
#endif
#if HAS_RADIANCE
in vec4 radiance_here;
flat in vec4 radiance_corner;
#endif
#if HAS_OPACITY
in vec4 opacity_here;
flat in vec4 opacity_corner;
#endif

/// A triangle whose corners lie on a line may cover samples once they are snapped to the sub-pixel
/// grid, and its interpolation then divides by no area: it has the value of its first corner.
vec4 finite(vec4 interpolated, vec4 corner_value) {
    const float kLargest = 3.4028235e38;
    return all(lessThanEqual(abs(interpolated), vec4(kLargest))) ? interpolated : corner_value;
}

void main() {
    Fragment f;
#if PERSPECTIVE
    f.depth = gl_FragCoord.z;
#else
    const float z = finite(vec4(z_camera), vec4(z_corner)).x;
    if (z < near_clip) discard;
    f.depth = near_clip / z;
    gl_FragDepth = f.depth;
#endif
    f.corner = corner;
    f.layer = int(layer_here);
#if OUTPUT == MARK
    f.grid = grid_here;
#endif
#if HAS_RADIANCE
    f.radiance = finite(radiance_here, radiance_corner);
#if OUTPUT == RADIANCE
    // Opaque: 1, or 0 of a holdout, which some devices interpolate to a unit in the last place less.
    f.radiance.w = radiance_corner.w;
#endif
#endif
#if HAS_OPACITY
    f.opacity = finite(opacity_here, opacity_corner);
#endif
    leave(f);
}
