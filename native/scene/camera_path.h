// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/camera.h"
#include "scene/knot_time.h"

namespace granita {

/// Where the camera is over the shutter.  What it sees goes straight between knots in camera space,
/// so there the inverse is linear, element by element.  Were the matrix itself, a place that stands
/// still would be put elsewhere between knots: with a focal length that changes by 3 % a
/// five-thousandth farther away, and so below the floor that it lies on.
class CameraPath {
  public:
    /// The camera outlives this.
    explicit CameraPath(const Camera& camera);

    Mat4d camera_from_world(const KnotTime& time) const;
    Mat4d world_from_camera(double time) const;

  private:
    const std::vector<Mat4d>& m_knots;  ///< world_from_camera
    std::vector<Mat4d> m_inverses;      ///< [knots]
};

}  // namespace granita
