// SPDX-License-Identifier: GPL-3.0-or-later
// Light that enters a surface, is scattered below it and leaves it elsewhere: what a program says
// of it at the points of a grid.  Lobes answer for directions at one point; this does not, so it
// stands beside them.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "math/vec.h"

namespace granita {

struct SurfaceClosure;

/// How a way into the medium begins.
enum class SubsurfaceEntry {
    Diffuse,
    Refracted,  ///< about visible facets of `alpha`
    Mixed,      ///< one way in two diffuse, the others refracted by the roughest facets
};

struct SubsurfaceLobe {
    bool walks = true;  ///< at random inside of the mesh; else goes by Burley's profile
    SubsurfaceEntry entry = SubsurfaceEntry::Diffuse;
    bool burley = false;  ///< leaves as Burley's (2012) diffuse lobe does
    /// Scatters light that goes on to a diffuse surface too; else it is diffuse for that.
    bool after_diffuse = true;
    std::vector<Vec3f> weight;  ///< [n] of what leaves; holds the albedo, as those of lobes do
    std::vector<Vec3f> normal;  ///< [n] unit, facing the viewer
    std::vector<Vec3f> albedo;  ///< [n] of a thick slab
    std::vector<Vec3f> radius;  ///< [n] metres, by channel: mean free path, or Burley's d
    std::vector<float> anisotropy, alpha, ior;  ///< [n]; the last two as light enters

    /// The least radius of what scatters; infinite where nothing does.
    float nearest(std::size_t i) const {
        float least = std::numeric_limits<float>::infinity();
        for (int c = 0; c < 3; ++c)
            if (weight[i][c] != 0.0f) least = std::min(least, radius[i][c]);
        return least;
    }
};

/// Moves to diffuse lobes what is not scattered: channels that go no farther than 1e-8 m, as in
/// Cycles; all of what rays know no body of; and for a diffuse surface, of which `was_diffuse`
/// tells, lobes that are not scattered after one.
void draw_as_diffuse(SurfaceClosure& closure, bool has_body, bool was_diffuse = false);

}  // namespace granita
