// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "shade/lights/light_bound.h"

namespace granita {

/// A range of lamps, and a bound on them together.
struct LightGroup {
    std::uint32_t *first, *last;
    LightBound bound;
};

/// Parts a range of lamps into at most `most` groups that are small in place, direction and power:
/// that of the largest cost is split in two until there are so many.  A group that could be parted
/// into its lamps stays whole, so that what is parted last is parted into many.  Reorders the
/// range.
std::vector<LightGroup> split_lights(const std::vector<LightBound>& lamps, std::uint32_t* first,
                                     std::uint32_t* last, std::size_t most);

}  // namespace granita
