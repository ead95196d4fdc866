// SPDX-License-Identifier: GPL-3.0-or-later
// A material's or world's node graph as Python hands it over: groups, reroutes and mutes are
// already flattened, constants folded, sockets renamed to Blender 4's identifiers.  Nodes are in
// evaluation order: a link always points to an earlier node.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "math/vec.h"
#include "scene/color_space.h"

namespace granita {

struct NodeLink {
    int node = -1;       ///< index in NodeGraph::nodes, smaller than the reader's own
    std::string output;  ///< socket identifier, e.g. "Color", "Fac", "BSDF"
    bool operator==(const NodeLink&) const = default;
};

/// Unlinked constant (scalar in x; vector in xyz; colour in rgb(a)) or link.
using NodeInput = std::variant<Vec4f, NodeLink>;
using NodeProperty = std::variant<double, std::string, std::vector<float>>;

struct Node {
    std::string type;  ///< Blender's bl_idname, e.g. "ShaderNodeBsdfPrincipled"
    std::string name;  ///< for messages
    std::map<std::string, NodeInput> inputs;
    std::map<std::string, NodeProperty>
        properties;  ///< enums as their identifiers, e.g. operation = "MULTIPLY"

    /// Of a property of this type; `fallback` where there is none.
    std::string text(const std::string& property, const std::string& fallback = "") const {
        const std::string* found = property_as<std::string>(property);
        return found ? *found : fallback;
    }
    double value(const std::string& property, double fallback = 0.0) const {
        const double* found = property_as<double>(property);
        return found ? *found : fallback;
    }
    bool flag(const std::string& property) const { return value(property) != 0.0; }
    bool operator==(const Node&) const = default;

  private:
    template <class T>
    const T* property_as(const std::string& property) const {
        const auto found = properties.find(property);
        return found == properties.end() ? nullptr : std::get_if<T>(&found->second);
    }
};

/// What is done with NodeGraph::displacement: shading normals are bent by it, or the surface is
/// moved, or both (which is the second where micropolygons are as fine as pixels).
enum class DisplacementMethod { Bump, Displacement, Both };

struct NodeGraph {
    std::vector<Node> nodes;
    NodeLink surface;       ///< node -1 = none
    NodeLink displacement;  ///< node -1 = none
    NodeLink volume;        ///< what is inside; node -1 = nothing
    DisplacementMethod displacement_method = DisplacementMethod::Displacement;

    bool moves_surface() const {
        return displacement.node >= 0 && displacement_method != DisplacementMethod::Bump;
    }
    bool bends_normals() const {
        return displacement.node >= 0 && displacement_method == DisplacementMethod::Bump;
    }
    bool has_volume() const { return volume.node >= 0; }
    /// There is something inside, but no surface around it.
    bool has_only_volume() const { return has_volume() && surface.node < 0; }
    bool operator==(const NodeGraph&) const = default;
};

struct Material {
    std::string name;
    int index = 0;         ///< pass_index
    bool holdout = false;  ///< cuts out of the picture what it does not let through
    NodeGraph graph;
    bool operator==(const Material&) const = default;
};

/// An image that nodes refer to by name.  Either a file (OpenImageIO reads it, tiled and cached) or
/// pixels, as numbers or as bytes.
struct Image {
    std::string name;
    std::string path;  ///< absolute; empty where there is no file
    std::shared_ptr<const ColorSpace> space = plain_color_space("sRGB");  ///< of a file or bytes
    /// CHANNEL_PACKED: no alpha of the colour; NONE: ignored; ASSOCIATED: colour is multiplied by
    /// it already; UNASSOCIATED: not yet; STRAIGHT, PREMUL: as the file says, or given pixels are.
    std::string alpha_mode = "STRAIGHT";
    int width = 0, height = 0;
    std::vector<float> pixels;  ///< [height][width][4], lower-left first, scene-linear, or empty
    std::vector<std::uint8_t> bytes;  ///< the same, in its space, or empty
    bool is_file() const { return pixels.empty() && bytes.empty(); }
    /// Its colours are products with alpha.
    bool has_products() const {
        return alpha_mode != "NONE" && alpha_mode != "CHANNEL_PACKED" && !space->is_data;
    }
    bool operator==(const Image& other) const;
};

}  // namespace granita
