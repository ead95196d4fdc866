// SPDX-License-Identifier: GPL-3.0-or-later
// The grids of a bucket as arrays for the device: positions at their knots, vertices, triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dice/grid.h"
#include "hider/grid_sweep.h"
#include "hider/raster/raster_seen.h"
#include "math/bounds.h"
#include "math/projection.h"

namespace granita {

/// Grids follow GridKey and micropolygons their index, whatever the order they were handed over in:
/// OpenGL keeps the first of equal depths, so ties fall as GridPool::before decides (decision 3).
/// Of each grid the opaque and the transparent micropolygons are drawn apart; what
/// micropolygon_class.h finds degenerate, clear or not finite is left out.
class RasterGeometry {
  public:
    /// Consecutive triangles that are culled and drawn together: one grid, or several small ones
    /// (the paper's remedy for a million grids of one micropolygon, 9.4).
    struct Range {
        std::uint32_t first_index = 0;  ///< of `indices`
        std::uint32_t index_count = 0;
        int knots = 1;                               ///< 1: does not move
        Lifespan lifespan;                           ///< of all of them
        std::uint32_t first_grid = 0, end_grid = 0;  ///< by key: those that it is of are among them
        RasterBounds swept;                          ///< over shutter and lens
        std::size_t first_box;                       ///< of the camera-space boxes at its knots
    };
    /// As raster/grid_places.glsl has it.
    struct GridPlace {
        std::uint32_t vertex, position;  ///< the first of each
        std::uint32_t vertices, knots;   ///< vertices of a knot
        Lifespan lifespan;
    };
    struct Place {
        std::uint32_t input;  ///< index in the list handed over
        int micropolygon;
    };

    /// The grids must outlive the object, the sweeps need not.
    explicit RasterGeometry(std::span<const GridSweep* const> sweeps);

    const std::vector<Range>& opaque() const { return m_opaque; }
    /// One grid each.
    const std::vector<Range>& transparent() const { return m_transparent; }
    /// Where a range can be seen at a time of the shutter, through any lens point.
    RasterBounds bounds_at(const Range& range, const Projection& projection, double t) const;
    /// Camera-space depths that a range takes during the shutter, metres.
    std::array<float, 2> depths(const Range& range) const;

    const std::vector<Vec3f>& positions() const { return m_positions; }
    const std::vector<std::uint32_t>& vertex_grids() const { return m_vertex_grids; }
    const std::vector<GridPlace>& grid_places() const { return m_places; }
    /// Two triangles a micropolygon, its corner 0 first in both.
    const std::vector<std::uint32_t>& indices() const { return m_indices; }
    /// In the order of their keys.
    const std::vector<const Grid*>& grids() const { return m_grids; }
    /// Of each the index in the list handed over.
    const std::vector<std::uint32_t>& inputs() const { return m_inputs; }
    /// Premultiplied colour and coverage a vertex; holdouts are 0 throughout.  0 for grids that are
    /// not seen: another bucket may be shading those.
    std::vector<Vec4f> radiance(const RasterSeen& seen) const;
    /// Opacity a vertex, w = 1 for holdouts.
    std::vector<Vec4f> opacity() const;
    /// The micropolygon whose corner 0 is that vertex.
    Place locate(std::uint32_t vertex) const;

    std::uint64_t micropolygons() const { return m_micropolygons; }
    /// Micropolygons with a vertex that is not finite.
    struct Dropped {
        const Grid* grid;
        std::uint64_t micropolygons;
    };
    const std::vector<Dropped>& dropped() const { return m_dropped; }

  private:
    struct Triangles {
        std::vector<std::uint32_t> opaque, transparent;
    };
    void append(const GridSweep& sweep, Triangles& triangles);
    void append_range(std::vector<Range>& ranges, const GridSweep& sweep, std::uint32_t first,
                      std::size_t end, bool combine);

    std::vector<const Grid*> m_grids;  ///< by key
    std::vector<std::uint32_t> m_inputs;
    std::vector<GridPlace> m_places;
    std::vector<Range> m_opaque, m_transparent;
    std::vector<Bounds3f> m_boxes;
    std::vector<Vec3f> m_positions;
    std::vector<std::uint32_t> m_vertex_grids, m_indices;
    std::vector<Dropped> m_dropped;
    std::uint64_t m_micropolygons = 0;
};

}  // namespace granita
