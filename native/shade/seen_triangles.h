// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "dice/grid.h"
#include "shade/refined_points.h"

namespace granita {

/// The triangles of a grid of small faces in which points lie, each once, and the points in them.
struct SeenTriangles {
    Grid grid;
    std::vector<RefinedPoint> points;

    /// @param faces a grid that has Grid::triangles.
    SeenTriangles(const Grid& faces, std::span<const RefinedPoint> wanted);
};

}  // namespace granita
