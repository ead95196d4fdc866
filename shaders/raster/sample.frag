// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample sees at its own place, time and lens point (paper, 9.3.5: per-pixel time sampling,
// figure 9.6): the triangle's corners at that time, the test, the depth.
//
// Corners are projected, moved and tested as compute/corner.glsl does it, relative to the sample's
// tile of 16 pixels, so a sample sees what it sees on the other executors.
// Defines: MOTION, LENS, LIFESPANS 0 or 1; OUTPUT as in leave.glsl.
#include "compute/corner.glsl"
#include "raster/leave.glsl"
#include "raster/samples.glsl"

layout(location = RASTER_RASTER_SCALE) uniform dvec2 raster_scale;
layout(location = RASTER_RASTER_CENTER) uniform dvec2 raster_center;
layout(location = RASTER_NEAR) uniform float near_clip;
flat in uint grid_here;
flat in uvec3 corners;
flat in vec3 begin[3];
#if MOTION
flat in vec3 end[3];
flat in uvec2 segment;
#endif
#if LIFESPANS
flat in vec2 lifespan;
#endif
#if HAS_RADIANCE
layout(std430, binding = RASTER_VERTEX_RADIANCE) readonly buffer Radiance { vec4 radiance[]; };
#endif
#if HAS_OPACITY
layout(std430, binding = RASTER_VERTEX_OPACITY) readonly buffer Opacity { vec4 opacity[]; };
#endif

/// Projection::homogeneous, and z.
vec4 homogeneous(vec3 p, dvec2 origin) {
    const double w = perspective ? double(p.z) : 1.0LF;
    const dvec2 xy = raster_scale * dvec2(p.xy) + (raster_center - origin) * w;
    return vec4(vec2(xy), float(w), p.z);
}

/// What is the same at all corners comes out as it is.
vec4 interpolate(vec4 a, vec4 b, vec4 c, vec2 share) {
    return a + share.x * (b - a) + share.y * (c - a);
}

void main() {
    const ivec2 texel = ivec2(gl_FragCoord.xy);
    if (!has_sample(texel)) discard;
    const vec4 here = sample_at(texel);  // x, y in its tile, t
#if LIFESPANS
    if (!(here.z >= lifespan.x && here.z < lifespan.y)) discard;
#endif
    const dvec2 origin = dvec2(tile_of(texel) * 16);
    vec4 c[4];
    for (int k = 0; k < 3; ++k) c[k] = homogeneous(begin[k], origin);
#if MOTION
    if (segment.y > 0u) {
        precise const float place = here.z * float(segment.y);
        const float start = float(segment.x);
        const bool last = segment.x + 1u == segment.y;
        if (!(place >= start && (last || place < start + 1.0))) discard;
        for (int k = 0; k < 3; ++k)
            c[k] = at_time(c[k], homogeneous(end[k], origin), place - start);
    }
#endif
    vec2 d[4];
    for (int k = 0; k < 3; ++k)
#if LENS
        d[k] = offset_lens(c[k], here.xy, lens_at(texel));
#else
        d[k] = offset_pinhole(c[k], here.xy);
#endif
    c[3] = c[2];
    d[3] = d[2];
    float key;
    if (!hit_micropolygon(c, d, kTriangleA, key)) discard;
    Fragment f;
    f.depth = perspective ? near_clip * key : near_clip / -key;
    f.corner = corners.x;
    f.grid = grid_here;
    f.layer = 0;
#if HAS_RADIANCE || HAS_OPACITY
    const vec3 edges = vec3(edge(d[1], d[2]), edge(d[2], d[0]), edge(d[0], d[1]));
    const float sum = edges.x + edges.y + edges.z;
    const vec2 share = sum != 0.0 ? clamp(edges.yz / sum, 0.0, 1.0) : vec2(0.0);
#endif
#if HAS_RADIANCE
    f.radiance = interpolate(radiance[corners.x], radiance[corners.y], radiance[corners.z], share);
#endif
#if HAS_OPACITY
    f.opacity = interpolate(opacity[corners.x], opacity[corners.y], opacity[corners.z], share);
#endif
    gl_FragDepth = f.depth;
    leave(f);
}
