// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a mesh around one of its own, by a profile of distance (King, Kulla, Conty and Fajardo
// 2013, "BSSRDF Importance Sampling").
#pragma once

#include <vector>

#include "shade/rays/ray_scene.h"
#include "shade/subsurface/burley_profile.h"

namespace granita {

struct Probed {
    RayScene::Met met;
    Vec3f weight;  ///< the profile over the density of what is found there
};

/// What a probe meets that is let down on a disc about `p`: along the normal, one time in two, or
/// across it, so that steep parts are found too: axes share by the power heuristic, channels by the
/// balance heuristic.  As Cycles has it, the profile of the distance to `p` is spread over the
/// probe's own circle: what lies above or below gets more than the profile alone would give; and a
/// probe is as long as the channel reaches that was drawn, so that others lose some of what is far.
/// @param normal geometric, unit.
/// @param rounding of places, metres: RayOffset's.
void probe(const RayScene& rays, const RayScene::Body& body, const BurleyProfile& profile,
           const Vec3f& p, const Vec3f& normal, float rounding, Vec2f u, std::vector<Probed>& out);

}  // namespace granita
