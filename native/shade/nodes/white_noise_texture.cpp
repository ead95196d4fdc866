// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/hash.h"
#include "shade/nodes/dimensions.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

template <std::size_t N>
void build(NodeBuilder& b) {
    const VectorSource color = b.map<Vec3f>(
        [](const Vec3f& v, float w) {
            std::array<float, N> place;
            for (std::size_t c = 0; c < N; ++c)
                place[c] = N == 1 || c == 3 ? w : v[static_cast<int>(c)];
            return hash_color(place);
        },
        b.vector("Vector"), b.number("W"));
    b.output_color("Color", color);
    b.output("Value", b.map<float>([](const Vec3f& c) { return c.x; }, color));
}

}  // namespace

void build_white_noise_texture(NodeBuilder& b) {
    with_dimensions(b, "noise_dimensions", [&](auto n) { build<n()>(b); });
}

}  // namespace granita
