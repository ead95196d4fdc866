// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "dice/grid.h"
#include "geometry/attribute_request.h"

namespace granita {

/// Gives the grid an attribute for each request; `fill(request, attribute)` sees to its values,
/// which may still be those of a grid before.
template <class Fill>
void make_attributes(Grid& grid, const std::vector<AttributeRequest>& requests, Fill fill) {
    grid.attributes.resize(requests.size());
    for (std::size_t a = 0; a < requests.size(); ++a) {
        grid.attributes[a].attribute = static_cast<int>(a);
        grid.attributes[a].width = requests[a].width;
        fill(requests[a], grid.attributes[a]);
    }
}

}  // namespace granita
