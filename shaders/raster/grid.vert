// SPDX-License-Identifier: GPL-3.0-or-later
// A grid's vertex at one instant, seen from one lens point, in the clip space of one cell of the
// frame (paper, 9.3.5: vertex motion).
//
// Defines: PERSPECTIVE 0 or 1; LAYERED 0 or 1: one draw fills several layers of the target, each a
// pass of its own; OUTPUT as in grid.frag.
//
// A vertex moves linearly between its grid's knots in camera space, before projection, and is then
// sheared by the lens as math/projection.h says.  All that, and the cell's corner, is computed
// in double and rounded once, as on the CPU: vertices that grids share stay shared, and pixel 16,000
// has the sub-pixel bits of pixel 0 (decision 2).  gl_Position.z is the near distance, so that the
// depth is near / w: the reversed float depth that is proportional to the depth key.
#if LAYERED
#extension GL_ARB_shader_viewport_layer_array : require
#endif
#include "raster/grid_output.glsl"
#include "raster/grid_places.glsl"

layout(std430, binding = RASTER_POSITIONS) readonly buffer Positions { float positions[]; };
// Shutter time, lens point in metres, 1 / focus distance.
layout(std430, binding = RASTER_PASSES) readonly buffer Passes { vec4 passes[]; };

layout(location = RASTER_GRID) in uint grid_index;
layout(location = RASTER_LAYER) in uint layer;
layout(location = RASTER_CLIP_SCALE) uniform dvec2 clip_scale;
layout(location = RASTER_CLIP_CENTER) uniform dvec2 clip_center;
layout(location = RASTER_NEAR) uniform float near_clip;
layout(location = RASTER_FIRST_PASS) uniform uint first_pass;
layout(location = RASTER_LATTICE_TURN) uniform double turn;  // tangent; 0: not rotated

// Two passes over the same geometry must find the same depth.
invariant gl_Position;

// Corner 0 is the provoking vertex of both triangles of its micropolygon, so it names it.
flat out uint corner;
flat out uint layer_here;
#if OUTPUT == MARK
flat out uint grid_here;
#endif
#if HAS_RADIANCE
layout(location = RASTER_RADIANCE) in vec4 radiance;
out vec4 radiance_here;
flat out vec4 radiance_corner;
#endif
#if HAS_OPACITY
layout(location = RASTER_OPACITY) in vec4 opacity;
out vec4 opacity_here;
flat out vec4 opacity_corner;
#endif
#if !PERSPECTIVE
out float z_camera;
flat out float z_corner;
#endif

dvec3 position(uint i) {
    return dvec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
}

void main() {
    const GridPlace grid = grids[grid_index];
    const vec4 pass = passes[first_pass + layer];
    uint i = grid.position + uint(gl_VertexID) - grid.vertex;
    dvec3 p = position(i);
    if (grid.knots > 1u) {
        const double place = double(pass.x) * double(grid.knots - 1u);
        const uint segment = min(uint(place), grid.knots - 2u);
        i += segment * grid.vertices;
        p = position(i);
        p += (place - double(segment)) * (position(i + grid.vertices) - p);
    }
#if PERSPECTIVE
    const double w = p.z;
    const float z_clip = near_clip;
#else
    const double w = 1.0LF;
    const float z_clip = 0.5;  // never clipped: grid.frag cuts at the sample
    z_camera = z_corner = float(p.z);
#endif
    p.xy += dvec2(pass.yz) * (p.z * double(pass.w) - 1.0LF);
    const dvec2 xy = clip_scale * p.xy + clip_center * w;
    gl_Position = vec4(vec2(xy + turn * dvec2(xy.y, -xy.x)), z_clip, float(w));
#if LAYERED
    gl_Layer = int(layer);
#endif
    layer_here = layer;
    corner = uint(gl_VertexID);
#if OUTPUT == MARK
    grid_here = grid_index;
#endif
#if HAS_RADIANCE
    radiance_here = radiance_corner = radiance;
#endif
#if HAS_OPACITY
    opacity_here = opacity_corner = opacity;
#endif
}
