// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shading_input.h"

#include "scene/knot_time.h"

namespace granita {

ShadingInput shading_input(const Grid& grid, const ShadingPoints& points, const Scene& scene,
                           const RayScene* rays, const Progress& progress) {
    ShadingInput in;
    in.points = &points;
    in.attributes = &grid.attributes;
    in.instance = &scene.instances[grid.instance];
    in.axes = ObjectAxes(matrix_at(in.instance->world_from_object, scene.options.frame_time));
    in.rays = rays;
    in.key = grid.key;
    in.progress = &progress;
    return in;
}

ShadingInput shading_input(const Grid& grid, const RefinedPoints& refined, const Scene& scene,
                           const RayScene* rays, const Progress& progress) {
    ShadingInput in = shading_input(grid, refined.points, scene, rays, progress);
    in.attributes = &refined.attributes;
    in.axes_at_times = refined.axes_at_times;
    return in;
}

}  // namespace granita
