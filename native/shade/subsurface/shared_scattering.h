// SPDX-License-Identifier: GPL-3.0-or-later
// What is scattered below a surface varies no faster than light goes there: points of a grid share
// what their ways have found, each channel as far as it goes.
#pragma once

#include <vector>

#include "math/vec.h"
#include "shade/bounces/neighbours.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/reflection.h"

namespace granita {

/// Of all that scatters at a point.
Vec3f subsurface_weight(const SurfaceClosure& closure, std::size_t point);

/// Of the ways of each of [points] that leave again, a channel: through thin walls they do not go
/// as far as the medium has it.
struct WaysGone {
    std::vector<Vec3f> weight;
    std::vector<Vec3f> along;  ///< the surface, metres, by weight
};

/// What points tell their neighbours of [points] `light`, by weight.
NoisyPoints tell_scattered(const ShadingPoints& points, const SurfaceClosure& closure,
                           const WaysGone& gone, const std::vector<Vec3f>& light);

/// Adds [points] what is scattered below them, by its weight, of lamps and the world and of other
/// surfaces (empty: none).
void reflect_scattered(const std::vector<Vec3f>& direct, const std::vector<Vec3f>& bounced,
                       const SurfaceClosure& closure, ReflectionParts* parts,
                       std::vector<Vec3f>& radiance);

/// [points] what reflect_scattered() adds beyond one light for all points by each one's weight: the
/// mean of what light falls on, be it the least part of them.
std::vector<Vec3f> scattered_beyond_typical(const std::vector<Vec3f>& direct,
                                            const std::vector<Vec3f>& bounced,
                                            const SurfaceClosure& closure);

}  // namespace granita
