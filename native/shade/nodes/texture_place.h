// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shade/programs/node_builder.h"

namespace granita {

/// Where a procedural texture is looked up: what is linked, or Generated, as mapped_place().
VectorSource texture_place(NodeBuilder& b);

/// A place as a texture node's own mapping moves it, which is older than the Mapping node.
VectorSource mapped_place(NodeBuilder& b, const VectorSource& place);

}  // namespace granita
