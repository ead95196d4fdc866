// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/speed.h"

#include "shade/shading_points.h"

namespace granita {
namespace {

/// At one of the adjacent frames, or at the frame.
Mat4d camera_from_object(const Scene& scene, const Instance& instance, int which) {
    const auto at = [&](const std::vector<Mat4d>& adjacent, const Mat4d& at_frame) {
        return which < 0 || adjacent.empty() ? at_frame : adjacent[which];
    };
    const Mat4d object = matrix_at(instance.world_from_object, scene.options.frame_time);
    return glm::inverse(at(scene.camera.adjacent, ShadingCamera(scene).world_from_camera)) *
           at(instance.adjacent, object);
}

/// False where it is not before the camera.
bool raster(const Projection& projection, const Mat4d& camera_from_object, const Vec3f& p,
            Vec2d& out) {
    const Vec3d seen(camera_from_object * glm::dvec4(Vec3d(p), 1.0));
    if (projection.perspective && !(seen.z > 0.0)) return false;
    out = projection.center +
          projection.scale * Vec2d(seen) / (projection.perspective ? seen.z : 1.0);
    return true;
}

}  // namespace

Speed::Speed(const Scene& scene, const Instance& instance)
    : m_projection(scene.camera.projection),
      m_now(camera_from_object(scene, instance, -1)),
      m_previous(camera_from_object(scene, instance, 0)),
      m_next(camera_from_object(scene, instance, 1)) {}

Vec4f Speed::at(const Vec3f& now, const Vec3f& previous, const Vec3f& next) const {
    Vec2d here, before, after;
    if (!raster(m_projection, m_now, now, here)) return Vec4f(0.0f);
    if (!raster(m_projection, m_previous, previous, before)) before = here;
    if (!raster(m_projection, m_next, next, after)) after = here;
    return Vec4f(Vec2f(before - here), Vec2f(here - after));
}

}  // namespace granita
