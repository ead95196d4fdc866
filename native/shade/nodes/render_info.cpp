// SPDX-License-Identifier: GPL-3.0-or-later
// Object Info: facts about the instance.
#include <string>

#include "scene/knot_time.h"
#include "shade/nodes/instance_value.h"
#include "shade/nodes/lamp_coordinates.h"
#include "shade/nodes/nodes.h"

namespace granita {

void build_object_info(NodeBuilder& b) {
    if (b.lamp() && is_object(b)) {
        b.output_vector("Location", lamp_location(b));
        for (const char* name : {"Color", "Alpha", "Object Index", "Random"})
            if (b.is_read(name)) b.warn(std::string(name) + " of a light is not read; it is 0");
    }
    if (b.is_world()) return;
    const double time = b.scene().options.frame_time;
    b.output_vector("Location", b.geometry<Vec3f>([time](const ShadingInput& in, std::size_t) {
        return Vec3f(matrix_at(in.instance->world_from_object, time)[3]);
    }));
    const InstanceValue color = instance_value(b, "COLOR");
    b.output_color("Color", color.color);
    b.output("Alpha", color.alpha);
    b.output("Object Index", b.geometry<float>([](const ShadingInput& in, std::size_t) {
        return static_cast<float>(in.instance->object_index);
    }));
    b.output("Material Index", FloatSource{-1, static_cast<float>(b.material_index())});
    b.output("Random", b.geometry<float>([](const ShadingInput& in, std::size_t) {
        return in.instance->random;
    }));
}

}  // namespace granita
