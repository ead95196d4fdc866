// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/lamp_coordinates.h"

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/nodes/coordinates.h"
#include "shade/programs/shading_camera.h"

namespace granita {

namespace {

Vec3f unit(const Vec3f& v) {
    const float length = glm::length(v);
    return length > 0.0f ? v / length : v;
}

/// A direction or an offset in the lamp's own axes.
Vec3f in_lamp(const LightFrame& frame, const Vec3f& world) {
    return Vec3f(glm::inverse(frame.axes) * Vec3d(world));
}

/// Longitude and latitude, [0, 1].
Vec2f around(const Vec3f& direction) {
    const Vec3f d = unit(direction);
    const float u =
        d.x == 0.0f && d.y == 0.0f ? 0.0f : 0.5f - 0.5f * kInversePi * std::atan2(d.x, d.y);
    return {u, 0.5f + kInversePi * std::asin(std::clamp(d.z, -1.0f, 1.0f))};
}

/// Over the square around a spot's cone, whatever its width.
Vec2f over_cone(const Vec3f& direction, float cone) {
    const Vec3f d = unit(direction);
    return 0.5f - 0.5f / (std::tan(0.5f * cone) * d.z) * Vec2f(d);
}

/// Over a sun's disc: in proportion to the sine of half the angle from its middle.
Vec2f over_disc(const LightFrame& frame, const Vec3f& to_light, float angle) {
    const float half = std::sin(0.25f * angle);
    if (half == 0.0f) return Vec2f(0.5f);
    const float chord = glm::length(to_light - frame.direction);
    return 0.5f + 0.5f / (half * chord) * Vec2f(in_lamp(frame, to_light));
}

Vec2f over_area(const Light& lamp, const Vec3f& p) {
    const bool one_size = lamp.shape == AreaShape::Square || lamp.shape == AreaShape::Disk;
    return 0.5f + Vec2f(p) / Vec2f(lamp.size.x, one_size ? lamp.size.x : lamp.size.y);
}

Vec2f uv(const Light& lamp, const PatternSample& at, const Vec3f& normal) {
    const LightFrame& frame = *at.frame;
    const LightSample& sample = *at.sample;
    switch (lamp.kind) {
        case LightKind::Point:
            return around(in_lamp(frame, normal));
        case LightKind::Spot:
            return over_cone(in_lamp(frame, -sample.direction), lamp.spot_size);
        case LightKind::Sun:
            return over_disc(frame, sample.direction, lamp.sun_angle);
        case LightKind::Area:
            break;
    }
    const Vec3f to = at.p + sample.direction * sample.distance - frame.position;
    return over_area(lamp, in_lamp(frame, to));
}

}  // namespace

bool is_object(const NodeBuilder& b) {
    return b.since(4, 5);
}

VectorSource lamp_location(NodeBuilder& b) {
    const Vec3f eye(ShadingCamera(b.scene()).world_from_camera[3]);
    return b.geometry<Vec3f>([eye](const ShadingInput& in, std::size_t i) {
        return in.of_lamp[i].frame->position + eye;
    });
}

VectorSource lamp_position(NodeBuilder& b) {
    if (!is_object(b)) return world_position_at(b, Shift::None);
    return b.geometry<Vec3f>([](const ShadingInput& in, std::size_t i) {
        const LightFrame& frame = *in.of_lamp[i].frame;
        return in_lamp(frame, in.points->p[i] - frame.position);
    });
}

VectorSource lamp_normal(NodeBuilder& b) {
    return b.geometry<Vec3f>([](const ShadingInput& in, std::size_t i) {
        return unit(glm::transpose(Mat3f(in.of_lamp[i].frame->axes)) * in.points->normal[i]);
    });
}

VectorSource lamp_view(NodeBuilder& b) {
    if (!b.since(4, 0)) return lamp_normal(b);
    return b.geometry<Vec3f>([](const ShadingInput& in, std::size_t i) {
        return in_lamp(*in.of_lamp[i].frame, in.points->view[i]);
    });
}

VectorSource lamp_uv(NodeBuilder& b) {
    return b.since(4, 0) ? lamp_parameters(b) : VectorSource{};
}

VectorSource lamp_parameters(NodeBuilder& b) {
    const Light& lamp = *b.lamp();
    const bool by_world = !b.since(4, 0) && lamp.kind != LightKind::Area;
    return b.geometry<Vec3f>([&lamp, by_world](const ShadingInput& in, std::size_t i) {
        const Vec3f& normal = in.points->normal[i];
        if (!by_world) return Vec3f(uv(lamp, in.of_lamp[i], normal), 0.0f);
        const Vec2f angles = around(normal);
        return Vec3f(1.0f - angles.x - angles.y, angles.x, 0.0f);
    });
}

}  // namespace granita
