// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/displacement_range.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>

#include "shade/nodes/gradient_noise.h"

namespace granita {
namespace {

struct Range {
    float low, high;
};

Range spanned(std::initializer_list<float> values) {
    return {std::min(values), std::max(values)};
}

/// Files of these hold values from 0 to 1.
bool is_unit_file(const std::string& path) {
    std::string end = path.substr(std::min(path.rfind('.'), path.size()));
    for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    static const std::set<std::string> kUnit = {".png", ".jpg", ".jpeg", ".tga", ".bmp", ".webp"};
    return kUnit.contains(end);
}

class Ranges {
  public:
    Ranges(const NodeGraph& graph, const std::vector<Image>& images)
        : m_graph(graph), m_images(images) {}

    /// Of a value, or of the channels of a colour; nullopt where nodes do not tell.
    std::optional<Range> of(const Node& node, const std::string& name, float fallback,
                            int depth = 0) const {
        const auto found = node.inputs.find(name);
        if (found == node.inputs.end()) return Range{fallback, fallback};
        if (const auto* value = std::get_if<Vec4f>(&found->second))
            return spanned({value->x, value->y, value->z});
        if (depth > kDeepest) return std::nullopt;
        const NodeLink& link = std::get<NodeLink>(found->second);
        return output(m_graph.nodes[static_cast<std::size_t>(link.node)], depth + 1);
    }

  private:
    /// Of what feeds a height; deeper graphs are sampled.
    static constexpr int kDeepest = 8;

    std::optional<Range> output(const Node& node, int depth) const {
        static const std::set<std::string> kUnit = {"ShaderNodeTexGradient",
                                                    "ShaderNodeTexWhiteNoise", "ShaderNodeTexWave"};
        const std::string& type = node.type;
        if (type == "ShaderNodeTexChecker") return checker(node, depth);
        if (kUnit.contains(type)) return Range{0.0f, 1.0f};
        if (type == "ShaderNodeTexImage") return image(node);
        if (type == "ShaderNodeTexNoise") return noise(node);
        if (type == "ShaderNodeRGBToBW") return of(node, "Color", 0.0f, depth);
        if (type == "ShaderNodeMath") return math(node, depth);
        return std::nullopt;
    }

    std::optional<Range> checker(const Node& node, int depth) const {
        const auto a = of(node, "Color1", 0.0f, depth), b = of(node, "Color2", 0.0f, depth);
        if (!a || !b) return std::nullopt;
        return spanned({a->low, a->high, b->low, b->high, 0.0f, 1.0f});  // the last two: of Fac
    }

    std::optional<Range> image(const Node& node) const {
        // What one tile holds tells nothing of the others.
        if (node.properties.contains("tiles")) return std::nullopt;
        const std::string name = node.text("image", "");
        for (const Image& image : m_images) {
            if (image.name != name) continue;
            if (!image.bytes.empty()) return Range{0.0f, 1.0f};
            if (image.is_file())
                return is_unit_file(image.path) ? std::optional(Range{0.0f, 1.0f}) : std::nullopt;
            const auto [low, high] = std::ranges::minmax(image.pixels);
            return Range{std::min(low, 0.0f), std::max(high, 1.0f)};
        }
        return std::nullopt;
    }

    /// A sum of octaves over the sum of their amplitudes.
    static std::optional<Range> noise(const Node& node) {
        const std::string dimensions = node.text("noise_dimensions", "3D");
        if (node.text("noise_type", "FBM") != "FBM" || node.value("normalize", 1.0) == 0.0 ||
            dimensions < "1D" || dimensions > "4D")
            return std::nullopt;
        const float most = noise_detail::kMost[static_cast<std::size_t>(dimensions[0] - '1')];
        return Range{0.5f - 0.5f * most, 0.5f + 0.5f * most};
    }

    std::optional<Range> math(const Node& node, int depth) const {
        if (node.flag("use_clamp")) return Range{0.0f, 1.0f};
        const std::string operation = node.text("operation", "ADD");
        if (operation == "SINE" || operation == "COSINE") return Range{-1.0f, 1.0f};
        const auto a = of(node, "Value", 0.0f, depth), b = of(node, "Value_001", 0.0f, depth);
        if (!a || !b) return std::nullopt;
        if (operation == "ADD") return Range{a->low + b->low, a->high + b->high};
        if (operation == "SUBTRACT") return Range{a->low - b->high, a->high - b->low};
        if (operation == "MULTIPLY")
            return spanned(
                {a->low * b->low, a->low * b->high, a->high * b->low, a->high * b->high});
        return std::nullopt;
    }

    const NodeGraph& m_graph;
    const std::vector<Image>& m_images;
};

}  // namespace

bool depends_on_instance(const NodeGraph& graph, const std::vector<std::set<std::string>>& read) {
    // Nodes that see nothing but their inputs and the geometry's own attributes.
    static const std::set<std::string> kOfGeometry = {"ShaderNodeValue",
                                                      "ShaderNodeRGB",
                                                      "ShaderNodeTexImage",
                                                      "ShaderNodeUVMap",
                                                      "ShaderNodeMapping",
                                                      "ShaderNodeMixRGB",
                                                      "ShaderNodeMix",
                                                      "ShaderNodeMath",
                                                      "ShaderNodeVectorMath",
                                                      "ShaderNodeMapRange",
                                                      "ShaderNodeClamp",
                                                      "ShaderNodeValToRGB",
                                                      "ShaderNodeRGBCurve",
                                                      "ShaderNodeVertexColor",
                                                      "ShaderNodeSeparateColor",
                                                      "ShaderNodeCombineColor",
                                                      "ShaderNodeSeparateRGB",
                                                      "ShaderNodeCombineRGB",
                                                      "ShaderNodeSeparateHSV",
                                                      "ShaderNodeCombineHSV",
                                                      "ShaderNodeSeparateXYZ",
                                                      "ShaderNodeCombineXYZ",
                                                      "ShaderNodeGamma",
                                                      "ShaderNodeInvert",
                                                      "ShaderNodeBrightContrast",
                                                      "ShaderNodeHueSaturation",
                                                      "ShaderNodeRGBToBW",
                                                      "ShaderNodeTexChecker",
                                                      "ShaderNodeTexGradient",
                                                      "ShaderNodeTexNoise",
                                                      "ShaderNodeTexVoronoi",
                                                      "ShaderNodeTexWave",
                                                      "ShaderNodeTexMagic",
                                                      "ShaderNodeTexBrick",
                                                      "ShaderNodeTexWhiteNoise",
                                                      "ShaderNodeVectorCurve",
                                                      "ShaderNodeFloatCurve",
                                                      "ShaderNodeVectorRotate",
                                                      "ShaderNodeNormal",
                                                      "ShaderNodeTexMusgrave"};
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        if (read[i].empty()) continue;
        const Node& node = graph.nodes[i];
        if (kOfGeometry.contains(node.type)) continue;
        if (node.type == "ShaderNodeDisplacement" || node.type == "ShaderNodeVectorDisplacement") {
            if (is_in_world(graph)) return true;
            continue;
        }
        if (node.type != "ShaderNodeTexCoord" || node.flag("from_instancer")) return true;
        const bool other = node.properties.contains("object_from_world");
        for (const std::string& output : read[i])
            if (output != "Generated" && output != "UV" && output != "Normal" &&
                (output != "Object" || other))
                return true;
    }
    return false;
}

bool is_in_world(const NodeGraph& graph) {
    const Node& node = graph.nodes[static_cast<std::size_t>(graph.displacement.node)];
    if (node.type == "ShaderNodeDisplacement") return node.text("space", "OBJECT") != "OBJECT";
    if (node.type == "ShaderNodeVectorDisplacement")
        return node.text("space", "TANGENT") == "WORLD";
    return true;  // whatever reaches the output is taken for a way in the world
}

float longest_displacement(const NodeGraph& graph, const std::vector<Image>& images) {
    constexpr float kUnknown = std::numeric_limits<float>::infinity();
    const Node& node = graph.nodes[static_cast<std::size_t>(graph.displacement.node)];
    if (node.type != "ShaderNodeDisplacement") return kUnknown;
    const Ranges ranges(graph, images);
    const auto height = ranges.of(node, "Height", 0.0f),
               midlevel = ranges.of(node, "Midlevel", 0.5f), scale = ranges.of(node, "Scale", 1.0f);
    if (!height || !midlevel || !scale) return kUnknown;
    return std::max(std::abs(scale->low), std::abs(scale->high)) *
           std::max(std::abs(height->low - midlevel->high), std::abs(height->high - midlevel->low));
}

}  // namespace granita
