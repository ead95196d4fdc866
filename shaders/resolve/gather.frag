// SPDX-License-Identifier: GPL-3.0-or-later
// The pixel filter over samples that lie anywhere: sum(w c) / sum(w) with w = f(dx) f(dy), as film/
// does it on the CPU (Film).  One pass: weights depend on both coordinates' own samples.
//
// Defines: FACTOR_COUNT, steps of the table of factors from 0 to the radius; IS_BOX 0 or 1; MARGIN, pixels.
#include "raster/samples.glsl"

layout(std430, binding = FILTER_TABLE) readonly buffer Table { float factors[]; };
layout(binding = FILTER_SOURCE) uniform sampler2D source;
layout(location = FILTER_ORIGIN) uniform ivec2 origin;  // the source's pixel of the target's (0, 0)
layout(location = FILTER_RADIUS) uniform float radius;  // pixels
layout(location = 0) out vec4 filtered;

float factor(float d) {
#if IS_BOX
    return d >= -radius && d < radius ? factors[0] : 0.0;
#else
    const float place = abs(d) * (float(FACTOR_COUNT) / radius);
    if (place >= float(FACTOR_COUNT)) return 0.0;
    const int i = int(place);
    return mix(factors[i], factors[i + 1], place - float(i));
#endif
}

void main() {
    const ivec2 own = origin + ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    float weight = 0.0;
    for (int y = -MARGIN; y <= MARGIN; ++y)
        for (int x = -MARGIN; x <= MARGIN; ++x)
            for (int s = 0; s < count.y; ++s) {
                const ivec2 texel =
                    (own + ivec2(x, y)) * count.x + ivec2(s % count.x, s / count.x);
                const vec2 d = place_in_pixel(texel) + vec2(x, y) - 0.5;
                const float w = factor(d.x) * factor(d.y);
                sum += w * texelFetch(source, texel, 0);
                weight += w;
            }
    filtered = weight != 0.0 ? sum / weight : vec4(0.0);
#if MARGIN == 0
    // Next to no sample within a narrow filter: what is seen nearest to the pixel's centre, as in film/
    // (kLeastWeight; samples' weights sum to about their number).
    if (weight > float(count.y) / 16.0) return;
    float least = 1e9;
    for (int s = 0; s < count.y; ++s) {
        const ivec2 texel = own * count.x + ivec2(s % count.x, s / count.x);
        const vec2 d = place_in_pixel(texel) - 0.5;
        if (dot(d, d) >= least) continue;
        least = dot(d, d);
        filtered = texelFetch(source, texel, 0);
    }
#endif
}
