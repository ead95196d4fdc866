// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates that textures use when nothing is linked.
#pragma once

#include "shade/programs/node_builder.h"

namespace granita {

/// Camera-relative world; the direction in the world's programs.
VectorSource position_at(NodeBuilder& b, Shift shift);
/// In the world; of a world shader the direction, too.
VectorSource world_position_at(NodeBuilder& b, Shift shift);
VectorSource generated_at(NodeBuilder& b, Shift shift);
/// An empty name: the UV map that is active for render.
VectorSource uv_at(NodeBuilder& b, const std::string& name, Shift shift);
/// NodeBuilder::attribute_beside of it.
VectorSource uv_beside(NodeBuilder& b, const std::string& name, Shift shift);
/// Unit, along growing u of a map, or the first derivative where it has none, square to the shading
/// normal; 0 where nothing is left of it.
VectorSource uv_tangent(NodeBuilder& b, const std::string& name);
/// The shading normal in object space, unit.
VectorSource object_normal(NodeBuilder& b);

}  // namespace granita
