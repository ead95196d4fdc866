// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/camera_path.h"
#include "scene/scene.h"

namespace granita {

/// The camera of the frame time as shading needs it.
struct ShadingCamera {
    Mat4d world_from_camera;
    bool perspective;

    explicit ShadingCamera(const Scene& scene)
        : world_from_camera(CameraPath(scene.camera).world_from_camera(scene.options.frame_time)),
          perspective(scene.camera.projection.perspective) {}
};

}  // namespace granita
