// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>

#include "shade/programs/node_builder.h"

namespace granita {

/// build(std::integral_constant N) for the dimensions that the node's property `key` names.
template <class Build>
void with_dimensions(NodeBuilder& b, const char* key, const Build& build) {
    const std::string dimensions = b.text(key, "3D");
    if (dimensions == "1D") return build(std::integral_constant<std::size_t, 1>());
    if (dimensions == "2D") return build(std::integral_constant<std::size_t, 2>());
    if (dimensions == "4D") return build(std::integral_constant<std::size_t, 4>());
    build(std::integral_constant<std::size_t, 3>());
}

}  // namespace granita
