// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_place.h"

namespace granita {

namespace {

Vec3f wrapped(const Vec3f& place) {
    constexpr float kTwoPi = 2.0f * std::numbers::pi_v<float>;
    return {std::fmod(place.x, kTwoPi), std::fmod(place.y, kTwoPi), std::fmod(place.z, kTwoPi)};
}

/// Sines of sums of sines of a place that is wrapped and scaled; each depth adds one line.
Vec3f magic(const Vec3f& p, int depth, float distortion) {
    const float d = distortion;
    float x = std::sin((p.x + p.y + p.z) * 5.0f);
    float y = std::cos((-p.x + p.y - p.z) * 5.0f);
    float z = -std::cos((-p.x - p.y + p.z) * 5.0f);
    if (depth > 0) {
        x *= d, y *= d, z *= d;
        y = -std::cos(x - y + z) * d;
    }
    if (depth > 1) x = std::cos(x - y - z) * d;
    if (depth > 2) z = std::sin(-x - y - z) * d;
    if (depth > 3) x = -std::cos(-x + y - z) * d;
    if (depth > 4) y = -std::sin(-x + y + z) * d;
    if (depth > 5) y = -std::cos(-x + y + z) * d;
    if (depth > 6) x = std::cos(x + y + z) * d;
    if (depth > 7) z = std::sin(x + y - z) * d;
    if (depth > 8) x = -std::cos(-x - y + z) * d;
    if (depth > 9) y = -std::sin(x - y + z) * d;
    if (d != 0.0f) x /= 2.0f * d, y /= 2.0f * d, z /= 2.0f * d;
    return {0.5f - x, 0.5f - y, 0.5f - z};
}

}  // namespace

void build_magic_texture(NodeBuilder& b) {
    const int depth = static_cast<int>(b.value("turbulence_depth", 2.0));
    const VectorSource vector = texture_place(b);
    // Blender before 5.2 wraps before it scales: another pattern beyond 2 pi of the origin.
    const VectorSource color = b.map<Vec3f>(
        [depth, wraps_first = !b.since(5, 2)](const Vec3f& v, float scale, float d) {
            return magic(wraps_first ? wrapped(v) * scale : wrapped(v * scale), depth, d);
        },
        vector, b.number("Scale", 5.0f), b.number("Distortion", 1.0f));
    b.output_color("Color", color);
    b.output("Fac", b.map<float>([](const Vec3f& c) { return (c.x + c.y + c.z) / 3.0f; }, color));
}

}  // namespace granita
