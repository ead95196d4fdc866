// SPDX-License-Identifier: GPL-3.0-or-later
// Light that enters a surface, is scattered below it and leaves it elsewhere: what a program says
// of it at the points of a grid.  Lobes answer for directions at one point; this does not, so it
// stands beside them.
#pragma once

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
    bool burley = false;        ///< leaves as Burley's (2012) diffuse lobe does
    std::vector<Vec3f> weight;  ///< [n] of what leaves; holds the albedo, as those of lobes do
    std::vector<Vec3f> normal;  ///< [n] unit, facing the viewer
    std::vector<Vec3f> albedo;  ///< [n] of a thick slab
    std::vector<Vec3f> radius;  ///< [n] metres, by channel: mean free path, or Burley's d
    std::vector<float> anisotropy, alpha, ior;  ///< [n]; the last two as light enters
};

/// Moves to diffuse lobes what scatters no farther than `radius`, by channel.
void draw_as_diffuse(SurfaceClosure& closure, float radius);

}  // namespace granita
