// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <embree3/rtcore.h>

#include "shade/rays/ray.h"

namespace granita {

/// A ray as Embree takes it; what else it holds is left as it is.
inline void set_ray(RTCRay& to, const Ray& from) {
    to.org_x = from.start.x, to.org_y = from.start.y, to.org_z = from.start.z;
    to.dir_x = from.direction.x, to.dir_y = from.direction.y, to.dir_z = from.direction.z;
    to.tfar = from.distance;
    to.time = from.time;
    to.mask = ~0u;
}

}  // namespace granita
