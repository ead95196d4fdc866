// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "dice/grid.h"
#include "scene/scene.h"
#include "shade/bsdf/lobe.h"
#include "shade/programs/shading_camera.h"

namespace granita {

/// Of what the grid is a part of.
inline GeometryKind kind_of(const Grid& grid, const Scene& scene) {
    return scene.geometry_of(scene.instances[grid.instance]).kind;
}

/// A grid's shading points in shading space.
ShadingPoints shading_points(const Grid& grid, const ShadingCamera& camera);

/// Of which nothing is read but how many they are: by programs that are still.
ShadingPoints painted_points(std::size_t count);

/// Turns the other side of some points of a mesh to the viewer, who sees it for most of the time.
void show_other_side(ShadingPoints& points, std::span<const std::size_t> which);

}  // namespace granita
