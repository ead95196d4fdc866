// SPDX-License-Identifier: GPL-3.0-or-later
// What hiding must know of a grid besides its vertices: made once, after dicing and opacity, and
// read by every executor in every bucket that the grid touches (decision 4).
//
// A grid is bounded in *parts*, rectangles of its micropolygons, one for each segment of its
// motion, so that a tile looks only at those that go over it; and in *slabs* of time as a whole, so
// that what is hidden for parts of the shutter is not looked at (space-time occlusion culling:
// Boulos et al. 2010).
#pragma once

#include <algorithm>
#include <vector>

#include "dice/grid.h"
#include "hider/micropolygon_class.h"
#include "hider/samples/lens_shape.h"
#include "hider/samples/sample_order.h"
#include "hider/time_slabs.h"
#include "math/projection.h"

namespace granita {

/// A rectangle of micropolygons of a grid.
struct GridPart {
    int i, j, n_u, n_v;  ///< the first, and how many

    /// Of grids of up to kNarrow rows all rows, kMostInRows micropolygons at most.  Of others kHigh
    /// rows: what is swept in squares, what is still as wide as vectors.
    static constexpr int kNarrow = 2, kMostInRows = 64, kHigh = 8, kSwept = kHigh, kStill = 16;

    /// Calls visit(first, count) for the runs of vertices that the corners of the part are.
    template <class Visit>
    void for_each_run(const Grid& grid, Visit visit) const {
        if (grid.disjoint) {  // separate micropolygons: four runs of corners
            for (int corner = 0; corner < 4; ++corner) visit(corner * grid.right() + i, n_u);
        } else if (n_u == grid.n_u) {
            visit(j * grid.up(), (n_v + 1) * grid.up());
        } else {
            for (int row = j; row <= j + n_v; ++row) visit(row * grid.up() + i, n_u + 1);
        }
    }
};

class GridSweep {
  public:
    /// The grid must outlive the object, and keep its positions and its opacity, which must be
    /// there where it varies.
    GridSweep(const Grid& grid, const Projection& projection, const LensShape& lens);

    const Grid& grid() const { return *m_grid; }
    /// Of its motion; 0 = still.
    int segments() const { return m_grid->motion ? m_grid->knots - 1 : 0; }
    const GridClasses& classes() const { return m_classes; }
    /// [knots], one of what is still: camera space, of the vertices that are finite.
    const std::vector<Bounds3f>& boxes() const { return m_boxes; }
    /// Of what moves; those of TimeSlab.
    const std::vector<TimeSlab>& slabs() const { return m_slabs; }
    const std::vector<GridPart>& parts() const { return m_parts; }
    /// Where samples of any lens point can see a part during a segment, and how near.
    const RasterBounds& bounds(std::size_t part, int segment) const {
        return m_bounds[part * static_cast<std::size_t>(std::max(1, segments())) +
                        static_cast<std::size_t>(segment)];
    }
    /// How far micropolygons go, roughly.
    const Sweep& reach() const { return m_reach; }
    std::uint64_t bytes() const;

  private:
    void divide(bool swept);
    void bound(const Projection& projection);

    const Grid* m_grid;
    GridClasses m_classes;
    std::vector<GridPart> m_parts;
    std::vector<RasterBounds> m_bounds;  ///< [parts][segments]
    std::vector<Bounds3f> m_boxes;
    std::vector<TimeSlab> m_slabs;
    Sweep m_reach;
};

}  // namespace granita
