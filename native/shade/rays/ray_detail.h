// SPDX-License-Identifier: GPL-3.0-or-later
// How closely rays have to meet the surface of a geometry: to a part of a pixel where the camera
// sees its nearest instance.
#pragma once

#include <vector>

#include "math/bounds.h"
#include "scene/scene.h"

namespace granita {

class RayDetail {
  public:
    /// `box`: of the geometry, object space.
    RayDetail(const Scene& scene, int geometry, const Bounds3f& box);

    /// The side of a pixel around a point of the geometry, both in object space; infinite where no
    /// caster shows it to the camera.
    float pixel(const Vec3f& p_object) const;

  private:
    /// A pixel is as large as this at each metre from the eye (object space), and at least
    /// `constant`.
    struct Eye {
        Vec3f p;
        float angle, constant;
        float pixel(const Vec3f& at) const { return angle * glm::distance(at, p) + constant; }
    };
    std::vector<Eye> m_eyes;
};

}  // namespace granita
