// SPDX-License-Identifier: GPL-3.0-or-later
// Emission and the world's Background: colour times strength.
#include "shade/nodes/nodes.h"

namespace granita {

void build_emission(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const FloatSource strength = product(b, b.number("Strength", 1.0f), weight);
    surface.add_emission(b, scaled(b, b.color("Color", Vec3f(1.0f)), strength));
}

void build_background(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    build_emission(b, surface, weight);
}

}  // namespace granita
