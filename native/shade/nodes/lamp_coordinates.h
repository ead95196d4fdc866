// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates of samples of a lamp, as its nodes are told them.
#pragma once

#include "shade/programs/node_builder.h"

namespace granita {

/// Whether the lamp has a space of its own: since Blender 4.5 lamps of Cycles are objects.
bool is_object(const NodeBuilder& b);
/// Where the lamp itself is, in the world.
VectorSource lamp_location(NodeBuilder& b);
/// In its own space, or the world's where it has none.
VectorSource lamp_position(NodeBuilder& b);
/// In its own axes, unit.
VectorSource lamp_normal(NodeBuilder& b);
/// To where light goes, in its own axes.
VectorSource lamp_view(NodeBuilder& b);
/// [0, 1] over a lamp's area, a spot's cone, a sun's disc and all around a point; 0 before
/// Blender 4.
VectorSource lamp_uv(NodeBuilder& b);
/// Geometry's output Parametric.
VectorSource lamp_parameters(NodeBuilder& b);

}  // namespace granita
