// SPDX-License-Identifier: GPL-3.0-or-later
// Blackbody and Wavelength: colours of light by one number, looked up in tables that the exporter
// makes.
#include <algorithm>
#include <memory>

#include "math/saturate.h"
#include "shade/nodes/nodes.h"

namespace granita {

VectorSource spectrum_color(NodeBuilder& b, const char* input) {
    const auto table = std::make_shared<const std::vector<float>>(b.table("spectrum"));
    if (table->size() < 6) {
        b.warn("has no table of colours");
        return {-1, Vec3f(1.0f)};
    }
    const auto low = static_cast<float>(b.value("low"));
    const auto high = static_cast<float>(b.value("high"));
    return b.map<Vec3f>(
        [=](float x) {
            const std::size_t segments = table->size() / 3 - 1;
            const auto last = static_cast<float>(segments);
            const float part = (x - low) / (high - low);
            const float place = saturate(part) * last;
            const auto i = static_cast<std::size_t>(std::min(place, last - 1.0f));
            const float t = place - static_cast<float>(i);
            const float* c = table->data() + 3 * i;
            return Vec3f(c[0], c[1], c[2]) * (1.0f - t) + Vec3f(c[3], c[4], c[5]) * t;
        },
        b.number(input));
}

void build_blackbody(NodeBuilder& b) {
    b.output_color("Color", spectrum_color(b, "Temperature"));
}

void build_wavelength(NodeBuilder& b) {
    b.output_color("Color", spectrum_color(b, "Wavelength"));
}

}  // namespace granita
