// SPDX-License-Identifier: GPL-3.0-or-later
// A grid's vertex from camera space to the clip space of one cell of the frame.
//
// Defines: PERSPECTIVE 0 or 1; WITH_RADIANCE 0 or 1.
//
// The cell's corner is subtracted in double and the result rounded once, as Projection::homogeneous
// does on the CPU: vertices that grids share stay shared, and pixel 16,000 has the sub-pixel bits of
// pixel 0 (decision 2).  gl_Position.z is the near distance, so that the depth is near / w: the
// reversed float depth that is proportional to the depth key.
#include "shared/raster_layout.h"

layout(location = RASTER_POSITION) in vec3 p_camera;
layout(location = RASTER_CLIP_SCALE) uniform dvec2 clip_scale;
layout(location = RASTER_CLIP_CENTER) uniform dvec2 clip_center;
layout(location = RASTER_NEAR) uniform float near_clip;

// Two passes over the same geometry must find the same depth.
invariant gl_Position;

// Corner 0 is the provoking vertex of both triangles of its micropolygon, so it names it.
flat out uint corner;
#if WITH_RADIANCE
layout(location = RASTER_RADIANCE) in vec4 radiance;
out vec4 radiance_here;
#endif
#if !PERSPECTIVE
out float z_camera;
#endif

void main() {
#if PERSPECTIVE
    const double w = double(p_camera.z);
    const float z_clip = near_clip;
#else
    const double w = 1.0LF;
    const float z_clip = 0.5;  // never clipped: grid.frag cuts at the sample
    z_camera = p_camera.z;
#endif
    const dvec2 xy = clip_scale * dvec2(p_camera.xy) + clip_center * w;
    gl_Position = vec4(vec2(xy), z_clip, float(w));
    corner = uint(gl_VertexID);
#if WITH_RADIANCE
    radiance_here = radiance;
#endif
}
