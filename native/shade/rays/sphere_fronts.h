// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres of point clouds are met from outside alone, as the camera sees them and as in Cycles:
// what passes or bends at a point does so once.  Embree tells of their far sides too, where what
// fills them ends.
#pragma once

#include <embree3/rtcore.h>

#include "math/vec.h"

namespace granita {

/// Whether the ray goes out where it hits.
inline bool leaves(const RTCFilterFunctionNArguments* arguments, unsigned i) {
    const unsigned n = arguments->N;
    const Vec3f across(RTCHitN_Ng_x(arguments->hit, n, i), RTCHitN_Ng_y(arguments->hit, n, i),
                       RTCHitN_Ng_z(arguments->hit, n, i));
    const Vec3f along(RTCRayN_dir_x(arguments->ray, n, i), RTCRayN_dir_y(arguments->ray, n, i),
                      RTCRayN_dir_z(arguments->ray, n, i));
    return glm::dot(across, along) > 0.0f;
}

}  // namespace granita
