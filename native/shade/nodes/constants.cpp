// SPDX-License-Identifier: GPL-3.0-or-later
// Value and RGB: the constants that the artist set on the node.  Scene Time: those of the frame.
#include "shade/nodes/nodes.h"

namespace granita {

void build_value(NodeBuilder& b) {
    b.output("Value", FloatSource{-1, static_cast<float>(b.value("value"))});
}

void build_scene_time(NodeBuilder& b) {
    b.output("Seconds", FloatSource{-1, static_cast<float>(b.value("seconds"))});
    b.output("Frame", FloatSource{-1, static_cast<float>(b.value("frame"))});
}

void build_rgb(NodeBuilder& b) {
    const std::vector<float> color = b.table("color");
    b.output_color("Color",
                   {-1, color.size() >= 3 ? Vec3f(color[0], color[1], color[2]) : Vec3f(0.0f)});
}

}  // namespace granita
