// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_hit.h"

namespace granita {

RayFrame::RayFrame(const Mat4d& matrix) {
    const Mat3d m(matrix);
    world_from_object = Mat3f(m);
    object_from_world = Mat3f(glm::inverse(m));
    // By cofactors: there may be no inverse.
    const Mat3d cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    world_from_normal = glm::dot(m[0], cofactors[0]) < 0.0 ? -cofactors : cofactors;
}

}  // namespace granita
