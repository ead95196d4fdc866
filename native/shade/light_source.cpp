// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/light_source.h"

#include "shade/shading_points.h"

namespace granita {

std::unique_ptr<LightSource> make_light_source(const Light& light, float frame_time,
                                               const Vec3d& origin) {
    const Mat4d m = matrix_at(light.world_from_light, frame_time);
    LightFrame frame;
    frame.position = Vec3f(Vec3d(m[3]) - origin);
    frame.axes = Mat3d(m);
    const Vec3d z(m[2]);
    const double length = glm::length(z);
    frame.direction = length > 0.0 ? Vec3f(-z / length) : Vec3f(0.0f, 0.0f, -1.0f);
    frame.power = light.color * light.energy;
    switch (light.kind) {
        case LightKind::Point:
        case LightKind::Spot:
            return make_point_light(light, frame);
        case LightKind::Sun:
            return make_sun_light(light, frame);
        case LightKind::Area:
            break;
    }
    return make_area_light(light, frame);
}

}  // namespace granita
