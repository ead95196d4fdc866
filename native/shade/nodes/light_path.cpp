// SPDX-License-Identifier: GPL-3.0-or-later
// Light Path: what a program is run for.  Programs are compiled anew for each type of ray that
// their graph tells apart, so its outputs are constants and what does not depend on them is folded
// away; of what ways from surface to surface meet, they have counted the depths.  Light Falloff,
// which the length of rays alone changes, is its neighbour.
#include "shade/nodes/light_path.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "shade/nodes/nodes.h"
#include "shade/programs/shading_camera.h"

namespace granita {

namespace {

constexpr const char* kLength = "Ray Length";
/// Which nothing counts but ways from surface to surface.
constexpr const char* kPassed = "Transparent Depth";

struct Depth {
    const char* output;
    int WayCounts::*count;
};
constexpr Depth kDepths[] = {{"Ray Depth", &WayCounts::bounces},
                             {"Diffuse Depth", &WayCounts::diffuse},
                             {"Glossy Depth", &WayCounts::glossy},
                             {"Transmission Depth", &WayCounts::transmission},
                             {kPassed, &WayCounts::passed}};

bool is_depth(const std::string& output) {
    return std::ranges::find(kDepths, output, &Depth::output) != std::end(kDepths);
}

/// Whether it is part of a way that counts what it meets.
bool is_counted(RayType ray) {
    return ray != RayType::Camera && ray != RayType::Shadow;
}

}  // namespace

float light_path_value(const std::string& output, RayType ray) {
    const bool reflected =
        ray == RayType::Diffuse || ray == RayType::Glossy || ray == RayType::Singular;
    // Through a surface, too; what is counted as glossy is reflected alone (Cycles).
    const bool glossy = (reflected || goes_through(ray)) && !is_diffuse(ray);
    const auto is = [&output](const char* name) { return output == name; };
    const bool yes =
        (is("Is Camera Ray") && ray == RayType::Camera) ||
        (is("Is Shadow Ray") && ray == RayType::Shadow) ||
        (is("Is Volume Scatter Ray") && ray == RayType::Scattered) ||
        (is("Is Singular Ray") && (ray == RayType::Singular || ray == RayType::Clear)) ||
        ((is("Is Transmission Ray") || is("Transmission Depth")) && goes_through(ray)) ||
        (is("Is Reflection Ray") && reflected) || (is("Ray Depth") && ray != RayType::Camera) ||
        (is("Is Diffuse Ray") && is_diffuse(ray)) ||
        (is("Diffuse Depth") && ray == RayType::Diffuse) || (is("Is Glossy Ray") && glossy) ||
        (is("Glossy Depth") && glossy && reflected);
    return yes ? 1.0f : 0.0f;
}

bool told_apart(const std::set<std::string>& outputs, RayType a, RayType b) {
    return std::any_of(outputs.begin(), outputs.end(), [&](const std::string& output) {
        if (output == kLength) return (a == RayType::Shadow) != (b == RayType::Shadow);
        if (is_depth(output) && is_counted(a) != is_counted(b)) return true;
        return light_path_value(output, a) != light_path_value(output, b);
    });
}

bool reads_ray_length(const NodeGraph& graph) {
    const auto is_length = [&graph](const auto& input) {
        const NodeLink* link = std::get_if<NodeLink>(&input.second);
        return link && link->output == kLength &&
               graph.nodes[static_cast<std::size_t>(link->node)].type == "ShaderNodeLightPath";
    };
    return std::ranges::any_of(graph.nodes, [&](const Node& node) {
        return node.type == "ShaderNodeLightFalloff" || std::ranges::any_of(node.inputs, is_length);
    });
}

FloatSource ray_length(NodeBuilder& b) {
    if (!b.has_surface()) return {-1, 0.0f};
    if (b.ray_type() == RayType::Shadow)
        return b.geometry<float>([](const ShadingInput& in, std::size_t) { return in.ray_length; });
    // Those of the camera start at its near clip plane.
    const Projection& projection = b.scene().camera.projection;
    const Vec3f forward(ShadingCamera(b.scene()).world_from_camera[2]);
    return b.geometry<float>(
        [forward, perspective = projection.perspective,
         near = static_cast<float>(projection.near_clip)](const ShadingInput& in, std::size_t i) {
            const std::vector<float>& lengths = in.points->ray_lengths;
            if (!lengths.empty()) return lengths[i];
            const Vec3f& p = in.points->p[i];
            const float depth = glm::dot(p, forward);
            if (!(depth > near)) return 0.0f;
            return (depth - near) * (perspective ? glm::length(p) / depth : 1.0f);
        });
}

void build_light_falloff(NodeBuilder& b) {
    const FloatSource length = ray_length(b);
    const FloatSource strength = b.map<float>(
        [](float x, float smooth, float t) {
            const float t2 = t * t;
            return smooth > 0.0f && std::isfinite(t2) ? x * t2 / (smooth + t2) : x;
        },
        b.number("Strength", 1.0f), b.number("Smooth"), length);
    // Suns are as far as can be; before Blender 4.3 nothing of them is left.
    const bool leaves_suns = b.since(4, 3);
    const auto farther = [leaves_suns](float x, float t) {
        return leaves_suns && !std::isfinite(t) ? x : x * t;
    };
    b.output("Quadratic", strength);
    const FloatSource linear = b.map<float>(farther, strength, length);
    b.output("Linear", linear);
    b.output("Constant", b.map<float>(farther, linear, length));
}

void build_light_path(NodeBuilder& b) {
    const auto of_type = [&b](const char* name) {
        return b.lamp() ? 0.0f : light_path_value(name, b.ray_type());
    };
    for (const char* name :
         {"Is Camera Ray", "Is Shadow Ray", "Is Diffuse Ray", "Is Glossy Ray", "Is Singular Ray",
          "Is Reflection Ray", "Is Transmission Ray", "Is Volume Scatter Ray"})
        b.output(name, FloatSource{-1, of_type(name)});
    const bool is_met = b.has_surface() && !b.is_volume() && is_counted(b.ray_type());
    for (const Depth& depth : kDepths) {
        const float least = of_type(depth.output);
        const auto counted = [least, count = depth.count](const ShadingInput& in, std::size_t i) {
            const std::vector<WayCounts>& counts = in.points->counts;
            return counts.empty() ? least : static_cast<float>(counts[i].*count);
        };
        b.output(depth.output, is_met && b.is_read(depth.output) ? b.geometry<float>(counted, true)
                                                                 : FloatSource{-1, least});
    }
    // Cycles counts lamps and the world as one bounce further than what is before them.
    const float before = b.lamp() ? 0.0f : light_path_value("Ray Depth", b.ray_type());
    if (b.is_world()) b.output("Ray Depth", FloatSource{-1, 1.0f + before});
    if (b.is_read(kPassed))
        b.warn("Transparent Depth is counted from surface to surface alone; else it is 0");
    b.output(kLength, ray_length(b));
}

}  // namespace granita
