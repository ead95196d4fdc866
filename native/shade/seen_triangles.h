// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "dice/grid.h"
#include "shade/refined_points.h"

namespace granita {

/// The triangles of a grid of small faces or ribbons in which points lie, and the points in
/// them.
struct SeenTriangles {
    Grid grid;
    std::vector<RefinedPoint> points;
    std::vector<Vec3f> opacity;  ///< [points] of the corners; empty: solid

    /// @param from a grid that has Grid::triangles.
    SeenTriangles(const Grid& from, std::span<const RefinedPoint> wanted);
};

}  // namespace granita
