// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "dice/grid.h"
#include "hider/sample_store.h"

namespace granita {

/// What the hider does with a micropolygon: Triangles bits plus kTransparent; 0 = nothing.
inline constexpr std::uint8_t kTransparent = 4;

struct GridClasses {
    std::vector<std::uint8_t> classes;          ///< [micropolygons]
    std::uint8_t common = 0xff, occurring = 0;  ///< bits that all classes have, and that any has
    std::uint64_t dropped = 0;                  ///< micropolygons with a vertex that is not finite
    std::vector<OpacityBounds> opacity;  ///< [micropolygons] where any is transparent, else empty
};

/// Triangles whose corners coincide at every knot have no area and are left out; so are
/// micropolygons with opacity 0 at all corners, unless the grid is additive.  Opacity of at least 1
/// in all channels of all corners is opaque.  Where samples will find their own opacity
/// (Grid::unsettled_opacity), it may be any.
GridClasses classify(const Grid& grid);

}  // namespace granita
