// SPDX-License-Identifier: GPL-3.0-or-later
// Highlights that are longer one way: which way, and by how much.
#pragma once

#include "shade/programs/surface_builder.h"

namespace granita {

/// Where the node's Tangent is not linked: around the z axis of Generated, and along curves.
VectorSource default_tangent(NodeBuilder& b);

/// Unit, about `axis` by a part of a turn.
VectorSource turned(NodeBuilder& b, const VectorSource& v, const VectorSource& axis,
                    const FloatSource& turn);

/// Stretches a lobe by an input from 0 to 1, as Principled and Metallic do.
void stretch_by_socket(NodeBuilder& b, LobeSource& lobe, const std::string& amount,
                       const std::string& rotation);
/// The same from -1 to 1, as Glossy does: in other units, and below 0 the other way.
void stretch_both_ways(NodeBuilder& b, LobeSource& lobe);

}  // namespace granita
