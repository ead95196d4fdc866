// SPDX-License-Identifier: GPL-3.0-or-later
// Stands in for the procedural textures that are not here: a flat grey of their mean, so that what
// they mix stays visible.  Black would take away what they were meant to vary.
#include "shade/nodes/nodes.h"

namespace granita {

void build_flat_texture(NodeBuilder& b) {
    const FloatSource half{-1, 0.5f};
    for (const char* name : {"Fac", "Value", "Distance", "Radius", "W"}) b.output(name, half);
    b.output_color("Color", {-1, Vec3f(0.5f)});
    b.output_vector("Position", {-1, Vec3f(0.5f)});
}

}  // namespace granita
