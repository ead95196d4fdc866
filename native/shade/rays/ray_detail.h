// SPDX-License-Identifier: GPL-3.0-or-later
// How closely rays have to meet the surface of a geometry: to a part of a pixel where the camera
// sees its nearest instance.
#pragma once

#include <vector>

#include "math/bounds.h"
#include "scene/scene.h"

namespace granita {

/// A pixel is as large as `angle` at each metre from `p` (object space), and at least `constant`.
struct Eye {
    Vec3f p{0.0f};
    float angle = 0.0f, constant = 0.0f;
    float pixel(const Vec3f& at) const { return angle * glm::distance(at, p) + constant; }
    bool operator==(const Eye&) const = default;
};

class RayDetail {
  public:
    RayDetail() = default;
    /// `box`: of the geometry, object space.
    RayDetail(const Scene& scene, int geometry, const Bounds3f& box);

    /// The side of a pixel around a point of the geometry, both in object space; infinite where no
    /// caster shows it to the camera.
    float pixel(const Vec3f& p_object) const;

    /// All that it depends on.
    const std::vector<Eye>& eyes() const { return m_eyes; }

  private:
    std::vector<Eye> m_eyes;
};

}  // namespace granita
