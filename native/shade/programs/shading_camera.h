// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/camera_path.h"
#include "scene/scene.h"

namespace granita {

/// The camera of the frame time as shading needs it.
struct ShadingCamera {
    Mat4d world_from_camera;
    bool perspective;
    float pixel;  ///< its width: radians, or metres of a parallel camera

    explicit ShadingCamera(const Scene& scene)
        : world_from_camera(CameraPath(scene.camera).world_from_camera(scene.options.frame_time)),
          perspective(scene.camera.projection.perspective),
          pixel(static_cast<float>(0.5 / scene.camera.projection.scale.x +
                                   0.5 / scene.camera.projection.scale.y)) {}
};

}  // namespace granita
