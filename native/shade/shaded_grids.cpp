// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shaded_grids.h"

#include <algorithm>
#include <cstring>

namespace granita {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_attribute(const GridAttribute& a, const GridAttribute& b) {
    return a.attribute == b.attribute && a.width == b.width && same_bytes(a.values, b.values) &&
           same_bytes(a.du, b.du) && same_bytes(a.dv, b.dv);
}

bool same_positions(const ShadingPositions& a, const ShadingPositions& b) {
    return a.step_u == b.step_u && a.step_v == b.step_v && same_bytes(a.anchors, b.anchors) &&
           same_bytes(a.point_of, b.point_of) && same_bytes(a.faces, b.faces);
}

bool same_before_shading(const Grid& a, const Grid& b) {
    return a.instance == b.instance && a.material == b.material && a.n_u == b.n_u &&
           a.n_v == b.n_v && a.disjoint == b.disjoint && a.knots == b.knots &&
           a.motion == b.motion && a.lifespan == b.lifespan && a.holdout == b.holdout &&
           a.point_share == b.point_share && same_bytes(a.positions, b.positions) &&
           same_positions(a.shading_positions, b.shading_positions) && same_bytes(a.p, b.p) &&
           same_bytes(a.normal, b.normal) && a.knot_normals == b.knot_normals &&
           same_bytes(a.normal_corners, b.normal_corners) &&
           same_bytes(a.geometric_normal, b.geometric_normal) && same_bytes(a.dp_du, b.dp_du) &&
           same_bytes(a.dp_dv, b.dp_dv) && same_bytes(a.ray_offset, b.ray_offset) &&
           same_bytes(a.rise, b.rise) && a.terminator_offset == b.terminator_offset &&
           same_bytes(a.opacity, b.opacity) &&
           same_bytes(a.unsettled_opacity, b.unsettled_opacity) &&
           std::ranges::equal(a.attributes, b.attributes, same_attribute);
}

}  // namespace

void ShadedGrids::add(const Grid& grid) {
    if ((grid.light_fraction > 0.0f || grid.told) && !grid.broken_radiance)
        m_grids.emplace(grid.key, &grid);
}

const Grid* ShadedGrids::find(const Grid& grid) const {
    const auto found = m_grids.find(grid.key);
    return found != m_grids.end() && same_before_shading(*found->second, grid) ? found->second
                                                                               : nullptr;
}

void take_shading(const Grid& from, Grid& to) {
    to.radiance = from.radiance;
    to.found = from.found;
    to.found_alone = from.found_alone;
    to.unsettled = from.unsettled;
    to.channels = from.channels;
    to.light_fraction = from.light_fraction;
    to.told_around = from.told_around;
}

}  // namespace granita
