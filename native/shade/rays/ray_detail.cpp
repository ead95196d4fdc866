// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_detail.h"

#include <algorithm>
#include <limits>

#include "scene/camera_path.h"

namespace granita {
namespace {

/// Of many instances the nearest stand for all: a geometry is one mesh to rays.
constexpr std::size_t kMostEyes = 16;

}  // namespace

RayDetail::RayDetail(const Scene& scene, int geometry, const Bounds3f& box) {
    const float time = scene.options.frame_time;
    const Mat4d world_from_camera = CameraPath(scene.camera).world_from_camera(time);
    const Projection& projection = scene.camera.projection;
    const double pixel = 1.0 / std::max(std::abs(projection.scale.x), std::abs(projection.scale.y));
    std::vector<std::pair<float, Eye>> found;
    for (const Instance& instance : scene.instances) {
        if (instance.geometry != geometry || !instance.casts_shadow) continue;
        const Mat4d object_from_camera =
            glm::inverse(matrix_at(instance.world_from_object, time)) * world_from_camera;
        Eye eye{Vec3f(object_from_camera[3]), 0.0f, 0.0f};
        if (projection.perspective) {
            eye.angle = static_cast<float>(pixel);
        } else {
            double least = std::numeric_limits<double>::infinity();
            for (int axis = 0; axis < 3; ++axis)
                least = std::min(least, glm::length(Vec3d(object_from_camera[axis])));
            eye.constant = static_cast<float>(pixel * least);
        }
        if (!is_finite(eye.p)) continue;
        const Vec3f nearest = box.empty() ? eye.p : glm::clamp(eye.p, box.lo, box.hi);
        found.emplace_back(eye.pixel(nearest), eye);
    }
    std::ranges::stable_sort(found, {}, [](const auto& f) { return f.first; });
    for (std::size_t i = 0; i < std::min(found.size(), kMostEyes); ++i)
        m_eyes.push_back(found[i].second);
}

float RayDetail::pixel(const Vec3f& p_object) const {
    float least = std::numeric_limits<float>::infinity();
    for (const Eye& eye : m_eyes) least = std::min(least, eye.pixel(p_object));
    return least;
}

}  // namespace granita
