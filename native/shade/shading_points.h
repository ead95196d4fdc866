// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dice/grid.h"
#include "scene/scene.h"
#include "shade/lobe.h"

namespace granita {

/// world_from_object (or any knots) at a shutter time, linear between knots.
Mat4d matrix_at(const std::vector<Mat4d>& knots, double time);

/// The camera of the frame time as shading needs it.
struct ShadingCamera {
    Mat4d world_from_camera{1.0};
    bool perspective = true;

    explicit ShadingCamera(const Scene& scene);
};

/// A grid's shading points in shading space.
ShadingPoints shading_points(const Grid& grid, const ShadingCamera& camera);

}  // namespace granita
