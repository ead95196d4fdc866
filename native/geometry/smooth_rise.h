// SPDX-License-Identifier: GPL-3.0-or-later
// How far above a coarse face the smooth surface lies that its normals tell of.  Shadow rays that
// start there end where that surface turns away from a light, not at each face (Hanika, "Hacking
// the Shadow Terminator", Ray Tracing Gems II, 2021; Cycles' Geometry Offset).
#pragma once

#include "geometry/corner_values.h"

namespace granita {

/// From a place on a smooth face with these corners, at which its normals are unit.
/// @param above whether the surface is seen from where its normals point to; else the way to the
///     surface as it is from inside.
Vec3f smooth_rise(const Vec3d (&p)[4], const Vec3d (&normals)[4], const CornerWeights& weights,
                  bool above);

}  // namespace granita
