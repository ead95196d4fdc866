// SPDX-License-Identifier: GPL-3.0-or-later
// How far above a point of a displaced surface its own triangles lie: rays meet it at a rate of its
// own, and what is diced finer may lie below what they meet.
#pragma once

#include <embree3/rtcore.h>

#include "shade/rays/ray.h"

namespace granita {

/// The nearest triangle of `built`, which holds nothing else, along a ray that is left through it,
/// not farther than its own size; infinite where there is none.  What faces the ray is something
/// else that hangs over it.  `from_behind`: the ray goes inwards.
float covering_distance(RTCScene built, const Ray& from, bool from_behind);

}  // namespace granita
