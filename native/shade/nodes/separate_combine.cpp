// SPDX-License-Identifier: GPL-3.0-or-later
// Separate and Combine: colours (RGB, HSV, HSL) and vectors.  The older one-mode nodes are the same
// with other socket names.  Get Vector Component, of a number cut off.
#include "shade/nodes/hsv.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

using Convert = Vec3f (*)(const Vec3f&);

Vec3f unchanged(const Vec3f& c) {
    return c;
}

std::string color_mode(NodeBuilder& b) {
    const std::string& type = b.node().type;
    if (type == "ShaderNodeSeparateHSV" || type == "ShaderNodeCombineHSV") return "HSV";
    return b.text("mode", "RGB");
}

void output_components(NodeBuilder& b, const VectorSource& v,
                       const std::array<const char*, 3>& names) {
    for (int c = 0; c < 3; ++c)
        b.output(names[c], b.map<float>([c](const Vec3f& x) { return x[c]; }, v));
}

VectorSource join(NodeBuilder& b, const std::array<const char*, 3>& names, Convert convert) {
    return b.map<Vec3f>(
        [convert](float x, float y, float z) {
            return convert({x, y, z});
        },
        b.number(names[0]), b.number(names[1]), b.number(names[2]));
}

constexpr std::array<const char*, 3> kRgb = {"R", "G", "B"}, kHsv = {"H", "S", "V"},
                                     kLong = {"Red", "Green", "Blue"}, kXyz = {"X", "Y", "Z"};

std::array<const char*, 3> socket_names(NodeBuilder& b) {
    const std::string& type = b.node().type;
    if (type == "ShaderNodeSeparateRGB" || type == "ShaderNodeCombineRGB") return kRgb;
    if (type == "ShaderNodeSeparateHSV" || type == "ShaderNodeCombineHSV") return kHsv;
    return kLong;
}

}  // namespace

void build_separate_color(NodeBuilder& b) {
    const std::string mode = color_mode(b);
    const Convert convert = mode == "HSV" ? hsv_from_rgb : mode == "HSL" ? hsl_from_rgb : unchanged;
    const VectorSource color = b.color(b.has("Image") ? "Image" : "Color");
    output_components(b, b.map<Vec3f>(convert, color), socket_names(b));
}

void build_combine_color(NodeBuilder& b) {
    const std::string mode = color_mode(b);
    const Convert convert = mode == "HSV" ? rgb_from_hsv : mode == "HSL" ? rgb_from_hsl : unchanged;
    const VectorSource color = join(b, socket_names(b), convert);
    b.output_color("Color", color);
    b.output_color("Image", color);
}

void build_separate_xyz(NodeBuilder& b) {
    output_components(b, b.vector("Vector"), kXyz);
}

void build_combine_xyz(NodeBuilder& b) {
    b.output_vector("Vector", join(b, kXyz, unchanged));
}

void build_vector_component(NodeBuilder& b) {
    b.output("Value", b.map<float>(
                          [](const Vec3f& v, float index) {
                              return index > -1.0f && index < 3.0f ? v[static_cast<int>(index)]
                                                                   : 0.0f;
                          },
                          b.vector("Vector"), b.number("Index")));
}

}  // namespace granita
