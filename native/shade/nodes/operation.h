// SPDX-License-Identifier: GPL-3.0-or-later
// The operation that an artist has chosen of a node that has many.
#pragma once

#include <map>
#include <string>

#include "shade/nodes/nodes.h"

namespace granita {

/// By the property `operation`; one that is not known is `usual`, with a warning.
template <class Function>
Function chosen_operation(NodeBuilder& b, const std::map<std::string, Function>& known,
                          const char* usual = "ADD") {
    const std::string name = b.text("operation", usual);
    const auto found = known.find(name);
    if (found != known.end()) return found->second;
    b.warn("operation " + name + " is not supported; rendered as " + usual);
    return known.at(usual);
}

}  // namespace granita
