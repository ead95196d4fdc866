// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/normalize_or.h"
#include "scene/camera_path.h"
#include "scene/scene.h"
#include "shade/programs/shading_camera.h"

namespace granita {

/// The eye over the shutter, in shading space.
class MovingEye {
  public:
    /// The scene outlives this.
    MovingEye(const Scene& scene, const ShadingCamera& camera)
        : m_path(scene.camera),
          m_static(is_static(scene.camera.world_from_camera)),
          m_perspective(camera.perspective),
          m_origin(camera.world_from_camera[3]),
          m_at_frame(relative(camera.world_from_camera)) {}

    /// Its axes in the columns (z ahead), and where it is in the last.
    Mat4d place(float time) const {
        return m_static ? m_at_frame : relative(m_path.world_from_camera(time));
    }
    /// Unit, towards it.
    Vec3f view(const Vec3f& p, float time) const {
        const Mat4d at = place(time);
        const Vec3f back = Mat3f(Mat3d(at)) * Vec3f(0, 0, -1);
        return m_perspective ? normalize_or(Vec3f(at[3]) - p, back) : back;
    }

  private:
    Mat4d relative(Mat4d at) const {
        at[3] -= glm::dvec4(m_origin, 0.0);
        return at;
    }

    CameraPath m_path;
    bool m_static;
    bool m_perspective;
    Vec3d m_origin;
    Mat4d m_at_frame;
};

}  // namespace granita
