// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/volumes/volume_space.h"

#include <algorithm>

namespace granita {

/// Texture space is a box along the axes, which the points that lie farthest apart tell.
VolumeSpace::VolumeSpace(const GeometryData& data, int knot) {
    const std::size_t count = data.vertex_count();
    if (count == 0) return;
    const Vec3f* const points = data.points.data() + static_cast<std::size_t>(knot) * count;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax_element(
            points, points + count,
            [axis](const Vec3f& a, const Vec3f& b) { return a[axis] < b[axis]; });
        const float from = (*low)[axis], length = (*high)[axis] - from;
        size[axis] = length;
        if (!(length > 0.0f)) continue;
        float first = 0.0f, last = 1.0f;
        if (!data.generated.empty()) {
            first = data.generated[static_cast<std::size_t>(low - points)][axis];
            last = data.generated[static_cast<std::size_t>(high - points)][axis];
        }
        scale[axis] = (last - first) / length;
        offset[axis] = first - from * scale[axis];
    }
}

}  // namespace granita
