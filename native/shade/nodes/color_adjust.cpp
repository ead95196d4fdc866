// SPDX-License-Identifier: GPL-3.0-or-later
// Gamma, Invert, Bright/Contrast, Hue/Saturation and RGB to BW.
#include <algorithm>
#include <cmath>

#include "shade/nodes/hsv.h"
#include "shade/nodes/nodes.h"

namespace granita {

void build_gamma(NodeBuilder& b) {
    b.output_color("Color", b.map<Vec3f>(
                                [](const Vec3f& c, float gamma) {
                                    Vec3f out = c;
                                    for (int i = 0; i < 3; ++i) {
                                        if (gamma == 0.0f) {
                                            out[i] = 1.0f;
                                        } else if (c[i] > 0.0f) {
                                            out[i] = std::pow(c[i], gamma);
                                        }
                                    }
                                    return out;
                                },
                                b.color("Color"), b.number("Gamma", 1.0f)));
}

void build_invert(NodeBuilder& b) {
    b.output_color("Color", b.map<Vec3f>(
                                [](float factor, const Vec3f& c) {
                                    return factor * (Vec3f(1.0f) - c) + (1.0f - factor) * c;
                                },
                                b.number("Fac", 1.0f), b.color("Color")));
}

void build_bright_contrast(NodeBuilder& b) {
    b.output_color("Color", b.map<Vec3f>(
                                [](const Vec3f& c, float brightness, float contrast) {
                                    const float offset = brightness - contrast * 0.5f;
                                    return glm::max((1.0f + contrast) * c + offset, Vec3f(0.0f));
                                },
                                b.color("Color"), b.number("Bright"), b.number("Contrast")));
}

void build_hue_saturation(NodeBuilder& b) {
    b.output_color("Color",
                   b.map<Vec3f>(
                       [](float hue, float saturation, float value, float factor, const Vec3f& c) {
                           Vec3f hsv = hsv_from_rgb(c);
                           hsv.x += hue + 0.5f;
                           hsv.x -= std::floor(hsv.x);
                           hsv.y = std::clamp(hsv.y * saturation, 0.0f, 1.0f);
                           hsv.z *= value;
                           const Vec3f mixed = factor * rgb_from_hsv(hsv) + (1.0f - factor) * c;
                           return glm::max(mixed, Vec3f(0.0f));
                       },
                       b.number("Hue", 0.5f), b.number("Saturation", 1.0f), b.number("Value", 1.0f),
                       b.number("Fac", 1.0f), b.color("Color")));
}

void build_rgb_to_bw(NodeBuilder& b) {
    b.output("Val", b.number_of(b.color("Color")));
}

}  // namespace granita
