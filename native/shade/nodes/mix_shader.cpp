// SPDX-License-Identifier: GPL-3.0-or-later
// Mix and Add Shader: how weight is shared among the closures below.
#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

void build_mix_shader(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    const FloatSource factor = b.map<float>(saturate, b.number("Fac", 0.5f));
    const FloatSource rest = b.map<float>([](float x) { return 1.0f - x; }, factor);
    surface.pass_weight(b, "Shader", product(b, weight, rest));
    surface.pass_weight(b, "Shader_001", product(b, weight, factor));
}

void build_add_shader(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    surface.set_additive();
    surface.pass_weight(b, "Shader", weight);
    surface.pass_weight(b, "Shader_001", weight);
}

}  // namespace granita
