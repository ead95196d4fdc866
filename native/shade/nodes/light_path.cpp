// SPDX-License-Identifier: GPL-3.0-or-later
// Light Path: what a program is run for.  Programs are compiled anew for each type of ray that
// their graph tells apart, so its outputs are constants and what does not depend on them is folded
// away.
#include "shade/nodes/light_path.h"

#include <algorithm>

#include "shade/nodes/nodes.h"

namespace granita {

namespace {

constexpr const char* kLength = "Ray Length";
/// What Cycles counts along a path and nothing here does.
constexpr const char* kUncounted = "Transparent Depth";

}  // namespace

float light_path_value(const std::string& output, RayType ray) {
    const bool reflected =
        ray == RayType::Diffuse || ray == RayType::Glossy || ray == RayType::Singular;
    const bool glossy = reflected && ray != RayType::Diffuse;
    const bool transmitted = ray == RayType::Transmission || ray == RayType::Clear;
    const auto is = [&output](const char* name) { return output == name; };
    const bool yes =
        (is("Is Camera Ray") && ray == RayType::Camera) ||
        (is("Is Shadow Ray") && ray == RayType::Shadow) ||
        (is("Is Singular Ray") && (ray == RayType::Singular || ray == RayType::Clear)) ||
        ((is("Is Transmission Ray") || is("Transmission Depth")) && transmitted) ||
        (is("Is Reflection Ray") && reflected) || (is("Ray Depth") && ray != RayType::Camera) ||
        ((is("Is Diffuse Ray") || is("Diffuse Depth")) && ray == RayType::Diffuse) ||
        ((is("Is Glossy Ray") || is("Glossy Depth")) && glossy);
    return yes ? 1.0f : 0.0f;
}

bool told_apart(const std::set<std::string>& outputs, RayType a, RayType b) {
    return std::any_of(outputs.begin(), outputs.end(), [&](const std::string& output) {
        if (output == kLength) return (a == RayType::Shadow) != (b == RayType::Shadow);
        return light_path_value(output, a) != light_path_value(output, b);
    });
}

void build_light_path(NodeBuilder& b) {
    for (const char* name :
         {"Is Camera Ray", "Is Shadow Ray", "Is Diffuse Ray", "Is Glossy Ray", "Is Singular Ray",
          "Is Reflection Ray", "Is Transmission Ray", "Is Volume Scatter Ray", "Ray Depth",
          "Diffuse Depth", "Glossy Depth", "Transparent Depth", "Transmission Depth"})
        b.output(name, FloatSource{-1, light_path_value(name, b.ray_type())});
    // Cycles counts the world as one bounce further than what is before it.
    if (b.is_world())
        b.output("Ray Depth", FloatSource{-1, 1.0f + light_path_value("Ray Depth", b.ray_type())});
    if (b.is_read(kUncounted)) b.warn("Transparent Depth is not counted; it is 0");
    if (b.is_world()) {
        b.output(kLength, FloatSource{-1, 0.0f});
    } else if (b.ray_type() == RayType::Shadow) {
        b.output(kLength, b.geometry<float>(
                              [](const ShadingInput& in, std::size_t) { return in.ray_length; }));
    } else {
        b.output(kLength, b.geometry<float>([](const ShadingInput& in, std::size_t i) {
            const std::vector<float>& lengths = in.points->ray_lengths;
            return lengths.empty() ? glm::length(in.points->p[i]) : lengths[i];
        }));
    }
}

}  // namespace granita
