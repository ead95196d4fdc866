// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_source.h"

#include "scene/knot_time.h"

namespace granita {
namespace {

float energy_at(const Light& light, float time) {
    const std::vector<float>& knots = light.energy_knots;
    if (knots.empty()) return light.energy;
    const KnotTime t = knot_time(static_cast<double>(time), static_cast<int>(knots.size()));
    if (t.fraction == 0.0) return knots[t.knot];
    return knots[t.knot] + (knots[t.knot + 1] - knots[t.knot]) * static_cast<float>(t.fraction);
}

}  // namespace

LightFrame light_frame(const Light& light, float time, const Vec3d& origin) {
    const Mat4d m = matrix_at(light.world_from_light, time);
    LightFrame frame;
    frame.position = Vec3f(Vec3d(m[3]) - origin);
    frame.axes = Mat3d(m);
    const Vec3d z(m[2]);
    const double length = glm::length(z);
    frame.direction = length > 0.0 ? Vec3f(-z / length) : Vec3f(0.0f, 0.0f, -1.0f);
    frame.power = light.color * energy_at(light, time);
    return frame;
}

std::unique_ptr<LightSource> make_light_source(const Light& light, const LightFrame& frame) {
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
