// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/grid.h"

namespace granita {

std::uint64_t Grid::bytes() const {
    std::uint64_t floats = 0;
    for (const GridAttribute& a : attributes) floats += a.values.size() + a.du.size() + a.dv.size();
    const std::uint64_t vectors =
        positions.size() + p.size() + normal.size() + geometric_normal.size() + dp_du.size() +
        dp_dv.size() + opacity.size() + radiance.size() + ray_offset.size() + rise.size() +
        found.size() + (found_alone ? found_alone->size() : 0);
    floats += channels.size() + shading_positions.anchors.size() +
              shading_positions.point_of.size() + shading_positions.faces.size() +
              8 * normal_corners.size();
    return sizeof(Grid) + unsettled.size() + unsettled_opacity.size() + 4 * floats +
           sizeof(Vec3f) * vectors;
}

}  // namespace granita
