// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/scene.h"

namespace granita {

/// How an instance moves over the frame, from one frame to the next (the pass Vector).
class Speed {
  public:
    Speed(const Scene& scene, const Instance& instance);

    /// Pixels: the place one frame before less that of now, and that of now less the one after, as
    /// Cycles has them.  0 towards what is not before the camera.  Places in object space.
    Vec4f at(const Vec3f& now, const Vec3f& previous, const Vec3f& next) const;

  private:
    const Projection& m_projection;
    Mat4d m_now, m_previous, m_next;  ///< camera from object
};

}  // namespace granita
