// SPDX-License-Identifier: GPL-3.0-or-later
// Hiding tells which grids are seen, not which of their points: of a tuft of hair or of leaves most
// are shaded for a few that show.  Where light is followed from surface to surface, which is what
// costs most, a ray to the eye tells them apart: those that it cannot see get fewer ways.
#pragma once

#include <vector>

#include "scene/scene.h"
#include "scene/shutter_warp.h"
#include "shade/bsdf/lobe.h"
#include "shade/lights/light_motion.h"
#include "shade/moving_eye.h"
#include "shade/rays/ray_scene.h"

namespace granita {

/// Fills `seen`: whether each point is through some point of the lens, without bounces its middle,
/// at some time of the shutter, one of each that it asks, or eight times where something moves
/// before it; `visible_times`: which of these; and `shares`: all light samples next to what is
/// seen, few out of sight and, in thickets, `edge` of them where what is seen ends.  Few ways cost
/// noise, which few see, or none among that of edges; and `thicket`.  The same whatever bucket
/// asks; all stay empty where all is seen.
/// @param points of the grid of `key`, lifted.
/// @param shutter nullptr where nothing moves.
/// @param edge part of the light samples, at most 1 (edge_light_fraction()).
/// @return points of which the side that is turned away at the frame time is seen more often.
std::vector<std::size_t> look_at(ShadingPoints& points, const PointPaths& paths, const GridKey& key,
                                 const RayScene& rays, const Scene& scene, const MovingEye& eye,
                                 const ShutterWarp* shutter, float edge);

}  // namespace granita
