// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/camera_rays.h"

#include <limits>

#include "scene/knot_time.h"

namespace granita {
namespace {

/// Through a raster position, one metre deep, in camera space.
Vec3d slope(const Projection& p, Vec2d raster, const Look& look) {
    Vec3d direction(0.0, 0.0, 1.0);
    if (p.perspective) direction = {(raster - p.center) / p.scale, 1.0};
    direction -= Vec3d(look.lens, 0.0) * (p.lens_radius * look.inverse_focus);
    return direction;
}

}  // namespace

Vec3f world_direction(const Camera& camera, Vec2d raster, const Look& look) {
    const Mat3d world_from_camera(matrix_at(camera.world_from_camera, look.t));
    return Vec3f(glm::normalize(world_from_camera * slope(camera.projection, raster, look)));
}

Look CameraRays::look(std::size_t i) const {
    Look look;
    if (!m_samples.t.empty()) look.t = m_samples.t[i];
    if (!m_samples.u.empty()) {
        look.lens = {m_samples.u[i], m_samples.v[i]};
        look.inverse_focus = m_samples.inverse_focus.empty() ? 1.0 / m_camera.projection.focus
                                                             : m_samples.inverse_focus[i];
    }
    return look;
}

CameraRays::Seen CameraRays::ray(std::size_t i, const Vec3d& origin, float frame_time) const {
    const Projection& p = m_camera.projection;
    const Look seen = look(i);
    const Vec2d raster = m_origin + Vec2d(m_samples.x[i], m_samples.y[i]);
    const float time = m_samples.t.empty() ? frame_time : m_samples.t[i];
    const Mat4d world_from_camera = matrix_at(m_camera.world_from_camera, time);
    Vec3d start(seen.lens * p.lens_radius, 0.0);
    if (!p.perspective) start += Vec3d((raster - p.center) / p.scale, 0.0);
    const Vec3d way = slope(p, raster, seen);
    const double length = glm::length(way);
    start += way * p.near_clip;
    return {{Vec3f(transform_point(world_from_camera, start) - origin),
             Vec3f(glm::normalize(Mat3d(world_from_camera) * way)),
             std::numeric_limits<float>::infinity(), time, -1, RayType::Camera},
            static_cast<float>(length),
            static_cast<float>(p.near_clip)};
}

}  // namespace granita
