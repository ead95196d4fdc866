// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dice/grid.h"
#include "scene/knot_time.h"
#include "scene/scene.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// The camera of the frame time as shading needs it.
struct ShadingCamera {
    Mat4d world_from_camera{1.0};
    bool perspective = true;

    explicit ShadingCamera(const Scene& scene);
};

/// A grid's shading points in shading space.
ShadingPoints shading_points(const Grid& grid, const ShadingCamera& camera);

}  // namespace granita
