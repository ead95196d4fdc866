// SPDX-License-Identifier: GPL-3.0-or-later
// A quadrilateral around all that a triangle covers during a segment of its motion, through any lens
// point (paper, 9.3.5: per-pixel time sampling).  Six vertices a triangle, an instance a segment, no
// attributes.  The fragment program gets the triangle's corners as they are: reading them there, a
// sample at a time, took llvmpipe most of its time.
//
// Defines: PERSPECTIVE, MOTION, LIFESPANS 0 or 1.  Samples lie anywhere in their pixels, so the quadrilateral consists
// of whole pixels.  Between knots vertices move linearly before projection: what lies in front of the
// near clip stays between its projections at the knots, whatever the lens point.
#include "raster/grid_places.glsl"

layout(std430, binding = RASTER_POSITIONS) readonly buffer Positions { float positions[]; };
layout(std430, binding = RASTER_TRIANGLES) readonly buffer Triangles { uint triangles[]; };
layout(std430, binding = RASTER_VERTEX_GRIDS) readonly buffer VertexGrids { uint vertex_grids[]; };

layout(location = RASTER_CLIP_SCALE) uniform dvec2 clip_scale;
layout(location = RASTER_CLIP_CENTER) uniform dvec2 clip_center;
layout(location = RASTER_NEAR) uniform float near_clip;
layout(location = RASTER_INVERSE_FOCUS) uniform dvec2 inverse_focus;  // of the nearest and the farthest; 0: no lens
layout(location = RASTER_LENS_RADIUS) uniform vec2 lens_radius;        // metres, along x and y
layout(location = RASTER_CELL_SIZE) uniform float cell_size;           // pixels

flat out uint grid_here;
flat out uvec3 corners;
flat out vec3 begin[3];
#if MOTION
flat out vec3 end[3];
flat out uvec2 segment;  // and how many; 0: does not move
#endif
#if LIFESPANS
flat out vec2 lifespan;
#endif

void main() {
    const uint triangle = uint(gl_VertexID) / 6u, k = uint(gl_VertexID) % 6u;
    corners = uvec3(triangles[3u * triangle], triangles[3u * triangle + 1u],
                    triangles[3u * triangle + 2u]);
    grid_here = vertex_grids[corners.x];
    const GridPlace grid = grids[grid_here];
#if LIFESPANS
    lifespan = vec2(grid.open, grid.close);
#endif
    vec2 lo = vec2(1.0), hi = vec2(-1.0);
    bool behind = false, before = false;
#if MOTION
    segment = uvec2(gl_InstanceID, grid.knots - 1u);
    const uint knots = min(grid.knots, 2u);
#else
    const uint knots = 1u;
#endif
    for (uint knot = 0u; knot < knots; ++knot)
        for (int i = 0; i < 3; ++i) {
            const uint at =
                3u * (grid.position + (uint(gl_InstanceID) + knot) * grid.vertices + corners[i] -
                      grid.vertex);
            const vec3 corner = vec3(positions[at], positions[at + 1u], positions[at + 2u]);
            const dvec3 p = dvec3(corner);
            if (knot == 0u) begin[i] = corner;
#if MOTION
            if (knot == knots - 1u) end[i] = corner;
#endif
#if PERSPECTIVE
            const double w = p.z;
            if (corner.z < near_clip) {
                behind = true;
                continue;
            }
#else
            const double w = 1.0LF;
#endif
            const vec2 place = vec2((clip_scale * p.xy + clip_center * w) / w);
            const dvec2 shears = inverse_focus.x == 0.0LF ? dvec2(0.0LF)
                                                          : abs(p.z * inverse_focus - 1.0LF);
            const double shear = max(shears.x, shears.y);
            const vec2 reach = lens_radius * vec2(abs(clip_scale * shear / w));
            lo = before ? min(lo, place - reach) : place - reach;
            hi = before ? max(hi, place + reach) : place + reach;
            before = true;
        }
    // What crosses the near clip may be anywhere; what lies behind it is nowhere.
    if (before && behind) {
        lo = vec2(-1.0);
        hi = vec2(1.0);
    }
    // A margin for what the places above and the test in sample.frag round.
    const float margin = 0.01;
    const vec2 first = floor((lo * 0.5 + 0.5) * cell_size - margin);
    const vec2 last = ceil((hi * 0.5 + 0.5) * cell_size + margin);
    const bvec2 at_end = bvec2(k == 1u || k == 2u || k == 4u, k == 2u || k == 4u || k == 5u);
    const vec2 pixel = clamp(mix(first, last, at_end), vec2(0.0), vec2(cell_size));
    gl_Position = vec4(before ? pixel * (2.0 / cell_size) - 1.0 : vec2(-2.0), 0.5, 1.0);
}
