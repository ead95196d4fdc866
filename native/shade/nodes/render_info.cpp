// SPDX-License-Identifier: GPL-3.0-or-later
// Light Path and Object Info: facts about the ray and the instance.  All points are seen by the
// camera; the world's programs are asked for the camera's picture and for light alike.
#include "shade/nodes/nodes.h"
#include "shade/shading_points.h"

namespace granita {

void build_light_path(NodeBuilder& b) {
    b.output("Is Camera Ray", FloatSource{-1, 1.0f});
    for (const char* name :
         {"Is Shadow Ray", "Is Diffuse Ray", "Is Glossy Ray", "Is Singular Ray",
          "Is Reflection Ray", "Is Transmission Ray", "Is Volume Scatter Ray", "Ray Depth",
          "Diffuse Depth", "Glossy Depth", "Transparent Depth", "Transmission Depth"})
        b.output(name, FloatSource{-1, 0.0f});
    if (b.is_world()) {
        b.output("Ray Length", FloatSource{-1, 0.0f});
        return;
    }
    b.output("Ray Length", b.geometry<float>([](const ShadingInput& in, std::size_t i) {
        return glm::length(in.points->p[i]);
    }));
}

void build_object_info(NodeBuilder& b) {
    if (b.is_world()) return;
    const double time = b.scene().options.frame_time;
    b.output_vector("Location", b.geometry<Vec3f>([time](const ShadingInput& in, std::size_t) {
        return Vec3f(matrix_at(in.instance->world_from_object, time)[3]);
    }));
    // The object's viewport colour is not part of the scene.
    b.output_color("Color", {-1, Vec3f(1.0f)});
    b.output("Alpha", FloatSource{-1, 1.0f});
    b.output("Object Index", b.geometry<float>([](const ShadingInput& in, std::size_t) {
        return static_cast<float>(in.instance->object_index);
    }));
    b.output("Material Index", FloatSource{-1, static_cast<float>(b.material_index())});
    b.output("Random", b.geometry<float>([](const ShadingInput& in, std::size_t) {
        return in.instance->random;
    }));
}

}  // namespace granita
