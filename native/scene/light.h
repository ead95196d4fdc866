// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "math/vec.h"
#include "scene/lifespan.h"
#include "scene/node_graph.h"

namespace granita {

enum class LightKind { Point, Sun, Spot, Area };
enum class AreaShape { Square, Rectangle, Disk, Ellipse };

/// Units are Blender's: point, spot and area in watts of radiant flux, sun in W/m^2.
struct Light {
    static constexpr int kAnyBounces = 1 << 15;
    std::string name;
    LightKind kind = LightKind::Point;
    std::vector<Mat4d> world_from_light;  ///< [K] Blender's light space: shines along -z
    Vec3f color{1.0f};
    float energy = 0.0f;
    std::vector<float> energy_knots;  ///< [K] over the shutter; empty = `energy` at all times
    Lifespan lifespan;                ///< when it shines; places are given throughout
    float radius = 0.0f;              ///< point, spot: metres
    bool soft_falloff = true;  ///< a radius means a disc that faces the point; false: a sphere
    float sun_angle = 0.0f;    ///< radians, full angle
    bool sun_flat = false;     ///< as Cycles before Blender 4: a disc that shines alike at each of
    ///< its places on a plane across its axis
    float spot_size = 0.0f;  ///< radians, full cone
    float spot_blend = 0.0f;
    bool spot_cosine = false;  ///< as Cycles before Blender 3.5: dimmed by the cosine to the axis,
    ///< the cone ignores the light's scale
    AreaShape shape = AreaShape::Square;
    Vec2f size{1.0f};  ///< area: metres, before the matrix's scale
    float spread = 3.14159265f;
    bool casts_shadow = true;
    bool lights_catchers = true;  ///< false: it is not of the plate (Instance::shadow_catcher)
    bool visible_diffuse = true, visible_glossy = true, visible_transmission = true;
    bool visible_volume = true;
    float diffuse_factor = 1.0f, specular_factor = 1.0f;
    /// Light and shadow linking: which bit of Instance::receives and ::blocks counts; -1 = it
    /// lights, and is shadowed by, everything.
    int receiver_set = -1, blocker_set = -1;
    int most_bounces = kAnyBounces;  ///< of surfaces between the camera and what it lights
    NodeGraph graph;  ///< surface: an Emission that multiplies its light; node -1 = none
    bool operator==(const Light&) const = default;
};

/// Whether an instance with this mask is in a set.
constexpr bool in_light_set(std::uint64_t mask, int set) {
    return set < 0 || ((mask >> set) & 1u) != 0;
}

struct World {
    std::string name;
    NodeGraph graph;           ///< surface: a Background; node -1 = black
    bool lights_scene = true;  ///< false where the view layer drops the world (use_sky off)
    /// Whether rays of a type see it; to the others it is black.
    bool visible_camera = true, visible_diffuse = true, visible_glossy = true,
         visible_transmission = true, visible_volume = true;
    int most_bounces = Light::kAnyBounces;  ///< as Light::most_bounces
    bool is_filled() const { return lights_scene && graph.has_volume(); }
    bool operator==(const World&) const = default;
};

}  // namespace granita
