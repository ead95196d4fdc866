// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dice/grid.h"
#include "scene/scene.h"
#include "scene/shutter_warp.h"

namespace granita {

/// How much of a sharp point's light samples a point of a blurred grid needs, at most 1.
///
/// Blur shows the mean of the points that pass a pixel: with as many samples each it would have
/// less noise than what is sharp, for more work.  But noise that is blurred is drawn out into
/// streaks, which the eye sees better than grain, so what is kept is the noise of the mean over a
/// square of four pixels.  Its variance is that of a point times the square pixels that a point
/// stands for times the integral of the square of the weights: boxes of 4 and of the blur's L
/// pixels, convolved (a circle of confusion counts as a square of its area).  Each of the samples
/// of a pixel sees one point alone, which adds the variance of a point over their number.  That of
/// a point falls with the square of its light samples, which are stratified (measured in a
/// penumbra: error as n to the power -.95).  The least blurred point of the grid decides.
/// `shutter`: of the scene's curve.  A row exposed for less counts what it sees.
/// @param grid positions at all its knots, camera space.
/// @return in (0, 1].
float light_sample_count(const Grid& grid, const Scene& scene, const ShutterWarp& shutter);

/// How much of the light samples a point at an edge needs, at most 1.
///
/// In the pixels of an edge Samples choose between things of other colours, an error that falls as
/// samples^-.75, beside which that of light, which falls as n^-.95, is to be small and no more.
/// Measured on files of hair and grass with bounces at equal seconds (docs/decisions/bounces.md):
/// 1 of 16 at 16 samples, 2 to 3 at 64.
float edge_light_fraction(int samples);

/// The same of a grid of ribbons or spheres, which a few pixels across are nothing but edges; as
/// many as ever from 8 pixels on.  1 for all else.
/// @param grid positions at all its knots, camera space.
/// @return in (0, 1].
float edge_light_sample_count(const Grid& grid, const Scene& scene);

/// How much of its light samples a point of a mesh's grid needs where these lie so close that a
/// pixel has many, at most 1: of faces like slivers, of what is seen edge-on throughout the
/// shutter. A pixel's variance is that of a point over how many of them it has, and over how many
/// of its samples see one each.  Below a dicing rate of 1 a pixel is a square of that side.
/// @param grid positions at all its knots, camera space.
/// @return in (0, 1].
float dense_light_fraction(const Grid& grid, const Scene& scene);

/// The nearest of steps a fourth root of 2 apart, of which 1 is one.  A lens that is opened a
/// little farther leaves most grids on theirs, and with it what they were shaded
/// (shade/shaded_grids.h).
float light_sample_step(float count);

}  // namespace granita
