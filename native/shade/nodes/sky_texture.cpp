// SPDX-License-Identifier: GPL-3.0-or-later
// A stand-in for Sky Texture: a gradient from horizon to zenith in the mean colours of each model
// at its default settings, without a sun (measured from Cycles 3.4, mean over all azimuths).
#include <algorithm>

#include "shade/nodes/coordinates.h"
#include "shade/nodes/nodes.h"

namespace granita {

void build_sky_texture(NodeBuilder& b) {
    struct Gradient {
        Vec3f below, horizon, zenith;
    };
    const std::string type = b.text("sky_type", "NISHITA");
    const Gradient gradient =
        type == "PREETHAM"
            ? Gradient{{0.79f, 0.77f, 0.95f}, {0.66f, 0.77f, 1.07f}, {0.70f, 0.94f, 1.55f}}
        : type == "HOSEK_WILKIE"
            ? Gradient{{0.07f, 0.22f, 0.32f}, {0.13f, 0.19f, 0.26f}, {0.07f, 0.11f, 0.13f}}
            : Gradient{{0.0f, 0.0f, 0.0f}, {8.3f, 7.7f, 5.9f}, {0.55f, 0.87f, 1.44f}};
    b.warn("Sky Texture is not supported; rendered as a plain gradient without a sun");
    const VectorSource direction =
        b.linked("Vector") ? b.vector("Vector") : generated_at(b, b.shift());
    b.output_color("Color", b.map<Vec3f>(
                                [gradient](const Vec3f& v) {
                                    const float length = glm::length(v);
                                    const float up = length > 0.0f ? v.z / length : 0.0f;
                                    if (up < 0.0f) return gradient.below;
                                    return glm::mix(gradient.horizon, gradient.zenith, up);
                                },
                                direction));
}

}  // namespace granita
