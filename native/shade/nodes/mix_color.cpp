// SPDX-License-Identifier: GPL-3.0-or-later
// Mix: the legacy MixRGB and the newer Mix with its three data types.  Blend modes as in Cycles.
#include <algorithm>
#include <cmath>
#include <map>

#include "shade/nodes/hsv.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

using Blend = Vec3f (*)(const Vec3f& a, const Vec3f& b, float t);

Vec3f lerp(const Vec3f& a, const Vec3f& b, float t) {
    return a * (1.0f - t) + b * t;
}

template <float (*Channel)(float, float, float)>
Vec3f by_channel(const Vec3f& a, const Vec3f& b, float t) {
    return {Channel(a.x, b.x, t), Channel(a.y, b.y, t), Channel(a.z, b.z, t)};
}

float overlay(float a, float b, float t) {
    if (a < 0.5f) return a * (1.0f - t + 2.0f * t * b);
    return 1.0f - (1.0f - t + 2.0f * t * (1.0f - b)) * (1.0f - a);
}

float divide(float a, float b, float t) {
    return b != 0.0f ? (1.0f - t) * a + t * a / b : a;
}

float dodge(float a, float b, float t) {
    if (a == 0.0f) return a;
    const float rest = 1.0f - t * b;
    return rest <= 0.0f ? 1.0f : std::min(a / rest, 1.0f);
}

float burn(float a, float b, float t) {
    const float rest = 1.0f - t + t * b;
    return rest <= 0.0f ? 0.0f : std::clamp(1.0f - (1.0f - a) / rest, 0.0f, 1.0f);
}

Vec3f screen(const Vec3f& a, const Vec3f& b, float t) {
    return Vec3f(1.0f) - ((1.0f - t) + t * (Vec3f(1.0f) - b)) * (Vec3f(1.0f) - a);
}

Vec3f soft_light(const Vec3f& a, const Vec3f& b, float t) {
    const Vec3f one(1.0f), screened = one - (one - b) * (one - a);
    return (1.0f - t) * a + t * ((one - a) * b * a + a * screened);
}

Vec3f hue(const Vec3f& a, const Vec3f& b, float t) {
    const Vec3f from = hsv_from_rgb(b);
    if (from.y == 0.0f) return a;
    const Vec3f hsv = hsv_from_rgb(a);
    return lerp(a, rgb_from_hsv({from.x, hsv.y, hsv.z}), t);
}

Vec3f saturation(const Vec3f& a, const Vec3f& b, float t) {
    Vec3f hsv = hsv_from_rgb(a);
    if (hsv.y == 0.0f) return a;
    hsv.y = (1.0f - t) * hsv.y + t * hsv_from_rgb(b).y;
    return rgb_from_hsv(hsv);
}

Vec3f value(const Vec3f& a, const Vec3f& b, float t) {
    Vec3f hsv = hsv_from_rgb(a);
    hsv.z = (1.0f - t) * hsv.z + t * hsv_from_rgb(b).z;
    return rgb_from_hsv(hsv);
}

Vec3f color(const Vec3f& a, const Vec3f& b, float t) {
    const Vec3f from = hsv_from_rgb(b);
    if (from.y == 0.0f) return a;
    return lerp(a, rgb_from_hsv({from.x, from.y, hsv_from_rgb(a).z}), t);
}

const std::map<std::string, Blend>& blends() {
    using V = const Vec3f&;
    static const std::map<std::string, Blend> kBlends = {
        {"MIX", lerp},
        {"ADD", [](V a, V b, float t) { return lerp(a, a + b, t); }},
        {"MULTIPLY", [](V a, V b, float t) { return lerp(a, a * b, t); }},
        {"SUBTRACT", [](V a, V b, float t) { return lerp(a, a - b, t); }},
        {"SCREEN", screen},
        {"DIVIDE", by_channel<divide>},
        {"DIFFERENCE", [](V a, V b, float t) { return lerp(a, glm::abs(a - b), t); }},
        {"EXCLUSION",
         [](V a, V b, float t) { return glm::max(lerp(a, a + b - 2.0f * a * b, t), Vec3f(0.0f)); }},
        {"DARKEN", [](V a, V b, float t) { return lerp(a, glm::min(a, b), t); }},
        {"LIGHTEN", [](V a, V b, float t) { return lerp(a, glm::max(a, b), t); }},
        {"OVERLAY", by_channel<overlay>},
        {"DODGE", by_channel<dodge>},
        {"BURN", by_channel<burn>},
        {"HUE", hue},
        {"SATURATION", saturation},
        {"VALUE", value},
        {"COLOR", color},
        {"SOFT_LIGHT", soft_light},
        {"LINEAR_LIGHT", [](V a, V b, float t) { return a + t * (2.0f * b - 1.0f); }},
    };
    return kBlends;
}

VectorSource blend_colors(NodeBuilder& b, const FloatSource& factor, const VectorSource& a,
                          const VectorSource& second, bool clamp_factor, bool clamp_result) {
    const std::string name = b.text("blend_type", "MIX");
    const auto found = blends().find(name);
    if (found == blends().end())
        b.warn("blend type " + name + " is not supported; rendered as Mix");
    const Blend blend = found == blends().end() ? lerp : found->second;
    return b.map<Vec3f>(
        [=](float t, const Vec3f& x, const Vec3f& y) {
            const Vec3f mixed = blend(x, y, clamp_factor ? std::clamp(t, 0.0f, 1.0f) : t);
            return clamp_result ? glm::clamp(mixed, Vec3f(0.0f), Vec3f(1.0f)) : mixed;
        },
        factor, a, second);
}

}  // namespace

void build_mix_rgb(NodeBuilder& b) {
    b.output_color("Color", blend_colors(b, b.number("Fac", 0.5f), b.color("Color1"),
                                         b.color("Color2"), true, b.flag("use_clamp")));
}

void build_mix(NodeBuilder& b) {
    const std::string type = b.text("data_type", "FLOAT");
    const bool clamp = b.value("clamp_factor", 1.0) != 0.0;
    const FloatSource factor = b.number("Factor_Float", 0.5f);
    const auto limit = [clamp](float t) { return clamp ? std::clamp(t, 0.0f, 1.0f) : t; };
    if (type == "RGBA") {
        b.output_color("Result_Color",
                       blend_colors(b, factor, b.color("A_Color"), b.color("B_Color"), clamp,
                                    b.flag("clamp_result")));
    } else if (type == "VECTOR") {
        const bool uniform = b.text("factor_mode", "UNIFORM") == "UNIFORM";
        const VectorSource factors = uniform
                                         ? b.map<Vec3f>([](float t) { return Vec3f(t); }, factor)
                                         : b.vector("Factor_Vector", Vec3f(0.5f));
        b.output_vector("Result_Vector",
                        b.map<Vec3f>(
                            [limit](const Vec3f& t, const Vec3f& x, const Vec3f& y) {
                                const Vec3f f(limit(t.x), limit(t.y), limit(t.z));
                                return x * (Vec3f(1.0f) - f) + y * f;
                            },
                            factors, b.vector("A_Vector"), b.vector("B_Vector")));
    } else {
        if (type != "FLOAT") b.warn("data type " + type + " is not supported; rendered as Float");
        b.output("Result_Float", b.map<float>(
                                     [limit](float t, float x, float y) {
                                         const float f = limit(t);
                                         return x * (1.0f - f) + y * f;
                                     },
                                     factor, b.number("A_Float"), b.number("B_Float")));
    }
}

}  // namespace granita
