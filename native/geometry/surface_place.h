// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/shared_geometry.h"

namespace granita {

/// A place on a patch of a geometry.
struct SurfacePlace {
    const BasePatch* patch = nullptr;  ///< nullptr: the patch that is spoken of
    Vec2d uv{0.0};
};

/// act(patch, first, count) for each run of places on one patch, none of them nullptr.
template <class Act>
void for_each_patch(std::span<const SurfacePlace> places, Act act) {
    for (std::size_t first = 0, end = 0; first < places.size(); first = end) {
        while (end < places.size() && places[end].patch == places[first].patch) ++end;
        act(*places[first].patch, first, end - first);
    }
}

}  // namespace granita
