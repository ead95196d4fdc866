// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of lobes as ways to other surfaces (LobeRay).
#pragma once

#include "shade/lights/lamp_set.h"

namespace granita {

/// From the border of a grid a little into it.  Where surfaces meet in an edge, points of it lie
/// on both: half of their rays would start behind the other.  Spheres have no such edges, and a
/// step along their tangents' chords would lead into them.
Vec3f inwards(const ShadingPoints& points, std::size_t i);
/// So far, of the way to the next point.
inline constexpr float kInwards = 0.02f;

/// Metres from a point to its neighbours.
float width_of(const ShadingPoints& points, std::size_t i);

/// How likely chance takes a way.
struct WayChance {
    float share;  ///< as LobeRay::share
    float pdf;    ///< of its direction, per solid angle; infinite for a mirror's
};

/// Puts the way of a sample into LitGrid::leaving, which is asked for.
/// @param value reflected radiance per radiance that comes along `ray`.
/// @param place in the sequence of its lobe.
void leave(const LampSet& set, LitGrid& grid, const LitPoint& point, const Ray& ray,
           const BsdfValue& value, const WayChance& chance, std::uint32_t place,
           const WorldAhead& world);

}  // namespace granita
