// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/camera_rays.h"

#include <limits>

namespace granita {
namespace {

/// Through a raster position, one metre deep, in camera space.
Vec3d slope(const Projection& p, Vec2d raster, const CameraSample& sample) {
    Vec3d direction(0.0, 0.0, 1.0);
    if (p.perspective) direction = {(raster - p.center) / p.scale, 1.0};
    direction -= Vec3d(sample.lens, 0.0) * (p.lens_radius * sample.inverse_focus);
    return direction;
}

}  // namespace

CameraSample camera_sample_of(const TileSamples& samples, std::size_t i,
                              const Projection& projection) {
    CameraSample sample;
    if (!samples.t.empty()) sample.t = samples.t[i];
    if (!samples.u.empty()) {
        sample.lens = {samples.u[i], samples.v[i]};
        sample.inverse_focus =
            samples.inverse_focus.empty() ? 1.0 / projection.focus : samples.inverse_focus[i];
    }
    return sample;
}

CameraLine camera_line(const Projection& projection, Vec2d raster, const CameraSample& sample) {
    Vec3d start(sample.lens * projection.lens_radius, 0.0);
    if (!projection.perspective)
        start += Vec3d((raster - projection.center) / projection.scale, 0.0);
    return {start, slope(projection, raster, sample)};
}

Vec3f world_direction(const Projection& projection, const Mat4d& world_from_camera, Vec2d raster,
                      const CameraSample& sample) {
    return Vec3f(glm::normalize(Mat3d(world_from_camera) * slope(projection, raster, sample)));
}

CameraRays::Seen CameraRays::ray(std::size_t i, const Vec3d& origin, float frame_time) const {
    const Projection& p = m_projection;
    const CameraSample seen = sample(i);
    const float time = m_samples.t.empty() ? frame_time : m_samples.t[i];
    const Mat4d world_from_camera = m_path.world_from_camera(time);
    const CameraLine line = camera_line(p, raster(i), seen);
    const double length = glm::length(line.way);
    return {{Vec3f(transform_point(world_from_camera, line.at(p.near_clip)) - origin),
             Vec3f(glm::normalize(Mat3d(world_from_camera) * line.way)),
             std::numeric_limits<float>::infinity(), time, -1, RayType::Camera},
            static_cast<float>(length),
            static_cast<float>(p.near_clip)};
}

}  // namespace granita
