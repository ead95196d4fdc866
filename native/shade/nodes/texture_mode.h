// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shade/programs/node_builder.h"
#include "shade/textures/texture.h"

namespace granita {

/// Of a node's Interpolation; Smart is Cubic, as in Cycles.
inline TextureFilter texture_filter(NodeBuilder& b) {
    const std::string filter = b.text("interpolation", "Linear");
    return filter == "Closest"  ? TextureFilter::Closest
           : filter == "Linear" ? TextureFilter::Linear
                                : TextureFilter::Cubic;
}

}  // namespace granita
