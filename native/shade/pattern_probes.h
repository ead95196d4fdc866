// SPDX-License-Identifier: GPL-3.0-or-later
// Points amid a grid's micropolygons that are asked whether its corners tell what it shows.  What
// nodes make of places is not filtered, nor are shadows of wires: lines finer than a micropolygon
// lie between its corners, and a pattern that keeps step with a grid is the same at all of them, so
// that no corner differs from those beside it (find_unsettled()).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "shade/lights/lamp_sight.h"
#include "shade/refined_points.h"

namespace granita {

/// What a surface is by itself, whatever lights it.
inline constexpr int kLookWidth = 13;

/// Of what scatters nothing below it, [points][kLookWidth]: colour and normals of what reflects,
/// how rough it is, the part of the colour that is diffuse, and what it sends out.
std::vector<float> looks_of(const ShadingPoints& points, const SurfaceClosure& closure);

/// [micropolygons]; empty: none is.
bool are_all_marked(std::span<const std::uint8_t> marks);

/// Whether some of a grid's points see a lamp and others do not.
bool any_differs(std::span<const LampSight> of_grid);

/// At places of the grid's own: in one of a few micropolygons, or, where corners have found
/// something, in all that they have not marked, if there are such.
class PatternProbes {
  public:
    /// @param marks [micropolygons] of which nothing is asked any more; empty: of none.
    PatternProbes(const Grid& grid, std::span<const std::uint8_t> marks);
    /// Some of them, to be asked again.
    explicit PatternProbes(std::vector<RefinedPoint> some) : points(std::move(some)) {}

    std::vector<RefinedPoint> points;

    /// Whether looks anywhere differ from those between corners by more than the threshold,
    /// displayed, lit as the grid is.
    /// @param looks at the points, and of the grid's shading points.
    /// @param is_lit whether light may be where corners are too dark to tell.
    bool miss_looks(const Grid& grid, std::span<const float> looks, std::span<const float> of_grid,
                    bool is_lit, float threshold) const;
    /// The same of what is seen as it is: `found` [points] where the grid has `values` [vertices].
    /// @param difference(a, b) as UnsettledThresholds::difference is.
    template <class Difference>
    bool miss(const std::vector<Vec3f>& values, std::span<const Vec3f> found, float threshold,
              const Difference& difference) const {
        for (std::size_t i = 0; i < points.size(); ++i)
            // What is no number is not what corners tell.
            if (!(difference(found[i], between(values, points[i])) <= threshold)) return true;
        return false;
    }

    /// Whether diffuse lobes at some point reflect what a corner around it does not tell of others'
    /// light (Grid::found), as nothing near it reflects any: it is unknown there, or dark.
    bool hide_light(const Grid& grid, std::span<const float> looks) const;

    /// Drops those at which no shadow could be missed, whatever is there.
    /// @param of_grid as missed_shadows()'s.
    void keep_shadowed(const Grid& grid, std::span<const LampSight> of_grid, float threshold);
    /// Those of the points, a few at most, that see a lamp otherwise than all corners around them,
    /// where its light would be missed, displayed.
    /// @param sights of the points, and of the grid's shading points.
    std::vector<RefinedPoint> missed_shadows(const Grid& grid, std::span<const LampSight> sights,
                                             std::span<const LampSight> of_grid,
                                             float threshold) const;
};

}  // namespace granita
