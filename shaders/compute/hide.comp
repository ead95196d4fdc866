// SPDX-License-Identifier: GPL-3.0-or-later
// Micropolygons against samples.  A workgroup owns 64 samples of a block of 4 x 4 pixels, an
// invocation one of them: it walks through the block's list and keeps the nearest surface in
// registers, so nothing is shared, locked or waited for.
//
// Defines: MOTION, LENS 0 or 1; PASS: the nearest opaque surface (COMPUTE_PASS_OPAQUE), or how many
// transparent ones lie in front of it (_COUNT), or which (_FILL).
#include "compute/blocks.glsl"
#include "compute/corner.glsl"
#include "compute/order.glsl"

layout(local_size_x = COMPUTE_GROUP_SIZE) in;

struct Entry {
    uint vertex;     // corner 0 at the segment's first knot
    uint right, up;  // to corners 1 and 3
    uint knot;       // from a vertex to itself at the segment's end
    uint id;
    uint pixels;     // x0, x1, y0, y1 in the tile, inclusive, 4 bits each
    uint segment;
    uint segments;   // 0 = static
    uint kind;
    float from, to;  // in time where it moves, else in u: when it may be over the block
};
layout(std430, binding = COMPUTE_ENTRIES) readonly buffer Entries { Entry entries[]; };
layout(std430, binding = COMPUTE_VERTICES) readonly buffer Vertices { vec4 vertices[]; };
// x and y of all samples, then, where there are any, u, v and 1 / focus distance, and t.
layout(std430, binding = COMPUTE_SAMPLES) readonly buffer Samples { float samples[]; };
// Key (bits of a float) and surface.
layout(std430, binding = COMPUTE_SEEN) buffer Seen { uvec2 seen[]; };
#if PASS != COMPUTE_PASS_OPAQUE
// COUNT: how many.  FILL: where to, or none: not in this part.
layout(std430, binding = COMPUTE_COUNTS) buffer Counts { uint counts[]; };
#endif
#if PASS == COMPUTE_PASS_FILL
layout(std430, binding = COMPUTE_OUTPUT) writeonly buffer Fragments { uint fragments[]; };
#endif

layout(location = COMPUTE_SAMPLE_STRIDE) uniform uint stride;
layout(location = COMPUTE_TIME_AT) uniform uint time_at;
layout(location = COMPUTE_LENS_AT) uniform uint lens_at;

/// Whether a sample at the pixel and the time, or u, can be inside.
bool may_hit(uint e, uvec2 pixel, float time, float u) {
    const uint bits = entries[e].pixels;
    const uvec4 p = uvec4(bits, bits >> 4, bits >> 8, bits >> 12) & 15u;
    if (pixel.x < p.x || pixel.x > p.y || pixel.y < p.z || pixel.y > p.w) return false;
#if MOTION || LENS
    const float coordinate = entries[e].segments > 0u ? time : u;
    return coordinate >= entries[e].from && coordinate <= entries[e].to;
#else
    return true;
#endif
}

void main() {
    const Block block = blocks[gl_WorkGroupID.x];
    const uint cell = gl_WorkGroupID.y * COMPUTE_GROUP_SIZE + gl_LocalInvocationID.x;
    if (cell >= 16u * samples_a_pixel) return;
    const uvec2 pixel = pixel_of(block, cell / samples_a_pixel);
    const uint in_tile = (pixel.y * 16u + pixel.x) * samples_a_pixel + cell % samples_a_pixel;
    const uint i = block.tile * 256u * samples_a_pixel + in_tile;

    const vec2 place = vec2(samples[i], samples[stride + i]);
#if MOTION
    const float time = samples[time_at + i];
#else
    const float time = 0.0;
#endif
#if LENS
    const vec3 lens = vec3(samples[lens_at + i], samples[lens_at + stride + i],
                           samples[lens_at + 2u * stride + i]);
#else
    const vec3 lens = vec3(0.0);
#endif
    const uvec2 before = seen[i];
    float nearest = uintBitsToFloat(before.x);
    uint surface = before.y;
#if PASS == COMPUTE_PASS_COUNT
    uint found = 0u;
#elif PASS == COMPUTE_PASS_FILL
    const uint at = gl_WorkGroupID.x * 16u * samples_a_pixel + cell;
    uint next = counts[at];
    if (next == kNone) return;
#endif
    const uint end = block.first + block.count;
    for (uint e = block.first;; ++e) {
        // Each invocation looks for its own next micropolygon, so that the test below finds most of
        // them with something to do (Aila and Laine 2009, while-while).
        while (e < end && !may_hit(e, pixel, time, lens.x)) ++e;
        if (e >= end) break;
        const Entry entry = entries[e];
        const uint corner[4] = uint[4](entry.vertex, entry.vertex + entry.right,
                                       entry.vertex + entry.right + entry.up,
                                       entry.vertex + entry.up);
        vec4 c[4];
        for (int k = 0; k < 4; ++k) c[k] = vertices[corner[k]];
#if MOTION
        if (entry.segments > 0u) {
            precise const float at_knot = time * float(entry.segments);
            const float start = float(entry.segment);
            const bool last = entry.segment + 1u == entry.segments;
            if (!(at_knot >= start && (last || at_knot < start + 1.0))) continue;
            for (int k = 0; k < 4; ++k)
                c[k] = at_time(c[k], vertices[corner[k] + entry.knot], at_knot - start);
        }
#endif
        vec2 d[4];
        for (int k = 0; k < 4; ++k)
#if LENS
            d[k] = offset_lens(c[k], place, lens);
#else
            d[k] = offset_pinhole(c[k], place);
#endif
        float key;
        if (!hit_micropolygon(c, d, entry.kind, key)) continue;
        const bool wins = key > nearest || (key == nearest && surface != kNone &&
                                            comes_before(entry.id, surface));
        if (!wins) continue;
#if PASS == COMPUTE_PASS_OPAQUE
        nearest = key;
        surface = entry.id;
#elif PASS == COMPUTE_PASS_COUNT
        ++found;
#else
        fragments[3u * next] = floatBitsToUint(key);
        fragments[3u * next + 1u] = in_tile;
        fragments[3u * next + 2u] = entry.id;
        ++next;
#endif
    }
#if PASS == COMPUTE_PASS_OPAQUE
    seen[i] = uvec2(floatBitsToUint(nearest), surface);
#elif PASS == COMPUTE_PASS_COUNT
    counts[gl_WorkGroupID.x * 16u * samples_a_pixel + cell] = found;
#endif
}
