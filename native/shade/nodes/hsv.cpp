// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/hsv.h"

#include <algorithm>
#include <cmath>

namespace granita {

namespace {

/// Hue in turns, for `range` = most minus least channel > 0.
float hue(const Vec3f& c, float most, float range) {
    float sixths;
    if (c.x == most) {
        sixths = (c.y - c.z) / range;
    } else if (c.y == most) {
        sixths = 2.0f + (c.z - c.x) / range;
    } else {
        sixths = 4.0f + (c.x - c.y) / range;
    }
    return sixths < 0.0f ? sixths / 6.0f + 1.0f : sixths / 6.0f;
}

float smallest_of(const Vec3f& c) {
    return std::min({c.x, c.y, c.z});
}

}  // namespace

Vec3f hsv_from_rgb(const Vec3f& rgb) {
    const float value = largest(rgb), range = value - smallest_of(rgb);
    const float saturation = value != 0.0f ? range / value : 0.0f;
    return {saturation != 0.0f ? hue(rgb, value, range) : 0.0f, saturation, value};
}

Vec3f rgb_from_hsv(const Vec3f& hsv) {
    const float s = hsv.y, v = hsv.z;
    if (s == 0.0f) return Vec3f(v);
    const float h = (hsv.x == 1.0f ? 0.0f : hsv.x) * 6.0f;
    const float sector = std::floor(h), f = h - sector;
    const float p = v * (1.0f - s), q = v * (1.0f - s * f), t = v * (1.0f - s * (1.0f - f));
    switch (static_cast<int>(sector)) {
        case 0:
            return {v, t, p};
        case 1:
            return {q, v, p};
        case 2:
            return {p, v, t};
        case 3:
            return {p, q, v};
        case 4:
            return {t, p, v};
        default:
            return {v, p, q};
    }
}

Vec3f hsl_from_rgb(const Vec3f& rgb) {
    const float most = largest(rgb), least = smallest_of(rgb);
    const float lightness = std::min(1.0f, (most + least) / 2.0f);
    if (most == least) return {0.0f, 0.0f, lightness};
    const float range = most - least;
    const float saturation =
        lightness > 0.5f ? range / (2.0f - most - least) : range / (most + least);
    return {hue(rgb, most, range), saturation, lightness};
}

Vec3f rgb_from_hsl(const Vec3f& hsl) {
    const float h = hsl.x * 6.0f;
    const Vec3f pure = glm::clamp(
        Vec3f(std::abs(h - 3.0f) - 1.0f, 2.0f - std::abs(h - 2.0f), 2.0f - std::abs(h - 4.0f)),
        Vec3f(0.0f), Vec3f(1.0f));
    const float chroma = (1.0f - std::abs(2.0f * hsl.z - 1.0f)) * hsl.y;
    return (pure - 0.5f) * chroma + hsl.z;
}

}  // namespace granita
