// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/knots.h"

#include <cmath>
#include <numeric>

#include "scene/camera_path.h"

namespace granita {
namespace {

bool is_finite(const Mat4d& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

}  // namespace

Knots combine_knots(const Scene& scene, const Instance& instance, const GeometryData& geometry,
                    bool geometry_static) {
    const std::vector<Mat4d>& world_from_object = instance.world_from_object;
    const std::vector<Mat4d>& world_from_camera = scene.camera.world_from_camera;
    const int segments[3] = {
        geometry_static ? 0 : geometry.knots - 1,
        is_static(world_from_object) ? 0 : static_cast<int>(world_from_object.size()) - 1,
        is_static(world_from_camera) ? 0 : static_cast<int>(world_from_camera.size()) - 1};

    Knots knots;
    long steps = 1;
    bool moves = false;
    for (const int s : segments)
        if (s > 0) steps = std::lcm(steps, static_cast<long>(s)), moves = true;
    if (!moves) steps = 0;
    if (steps > kMaxKnots - 1) {
        steps = kMaxKnots - 1;
        knots.capped = true;
    }
    knots.count = static_cast<int>(steps) + 1;

    const CameraPath path(scene.camera);
    const auto compose = [&](const KnotTime& object, const KnotTime& camera) {
        const Mat4d composed =
            path.camera_from_world(camera) * matrix_at(world_from_object, object);
        knots.finite = knots.finite && is_finite(composed);
        return composed;
    };
    const int object_knots = static_cast<int>(world_from_object.size());
    const int camera_knots = static_cast<int>(world_from_camera.size());
    const int n = static_cast<int>(steps);
    for (int k = 0; k < knots.count; ++k)
        knots.camera_from_object.push_back(
            compose(knot_time(k, n, object_knots), knot_time(k, n, camera_knots)));

    const double time = scene.options.frame_time;
    const KnotTime frame = knot_time(time, knots.count);
    knots.frame_knot = static_cast<int>(frame.knot);
    knots.frame_fraction = frame.fraction;
    knots.frame_camera_from_object = frame.fraction == 0.0 ? knots.camera_from_object[frame.knot]
                                                           : compose(knot_time(time, object_knots),
                                                                     knot_time(time, camera_knots));
    return knots;
}

}  // namespace granita
