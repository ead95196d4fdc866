// SPDX-License-Identifier: GPL-3.0-or-later
// Checker and Gradient Texture.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "math/sampling.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_place.h"

namespace granita {

namespace {

/// 1 on the cubes of the first colour, the odd ones.  The nudge keeps faces that lie on whole
/// numbers, where rounding would decide, on one side (Cycles').
float checker(const Vec3f& p, float scale) {
    const Vec3f q = (p * scale + 1e-6f) * 0.999999f;
    int sum = 0;
    for (int c = 0; c < 3; ++c) sum += std::abs(static_cast<int>(std::floor(q[c]))) % 2;
    return sum % 2 == 0 ? 0.0f : 1.0f;
}

float gradient(const std::string& type, const Vec3f& p) {
    if (type == "QUADRATIC") {
        const float r = std::max(p.x, 0.0f);
        return r * r;
    }
    if (type == "EASING") {
        const float r = std::clamp(p.x, 0.0f, 1.0f);
        return 3.0f * r * r - 2.0f * r * r * r;
    }
    if (type == "DIAGONAL") return (p.x + p.y) * 0.5f;
    if (type == "RADIAL") return std::atan2(p.y, p.x) / (2.0f * kPi) + 0.5f;
    if (type == "SPHERICAL" || type == "QUADRATIC_SPHERE") {
        const float r = std::max(0.999999f - glm::length(p), 0.0f);
        return type == "SPHERICAL" ? r : r * r;
    }
    return p.x;
}

}  // namespace

void build_checker(NodeBuilder& b) {
    const FloatSource first = b.map<float>(checker, texture_place(b), b.number("Scale", 5.0f));
    b.output("Fac", first);
    b.output_color(
        "Color",
        b.map<Vec3f>([](float f, const Vec3f& x, const Vec3f& y) { return f != 0.0f ? x : y; },
                     first, b.color("Color1", Vec3f(0.8f)), b.color("Color2", Vec3f(0.2f))));
}

void build_gradient(NodeBuilder& b) {
    const std::string type = b.text("gradient_type", "LINEAR");
    const FloatSource factor =
        b.map<float>([type](const Vec3f& p) { return std::clamp(gradient(type, p), 0.0f, 1.0f); },
                     texture_place(b));
    b.output("Fac", factor);
    b.output_color("Color", b.map<Vec3f>([](float x) { return Vec3f(x); }, factor));
}

}  // namespace granita
