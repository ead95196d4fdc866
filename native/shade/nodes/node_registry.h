// SPDX-License-Identifier: GPL-3.0-or-later
// Which function builds which node.  A node that is not understood has a kin: the known node that
// looks most like it (Glass -> Glossy); the artist is told.
#pragma once

#include <string>

#include "shade/programs/surface_builder.h"

namespace granita {

struct NodeKind {
    /// Values: writes outputs.  nullptr for closures.
    void (*build)(NodeBuilder&) = nullptr;
    /// Closures: adds to the surface with the weight that reached the node.
    void (*build_closure)(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight) = nullptr;
    /// Not nullptr: this is not the node itself but its kin, which it is replaced by.
    const char* kin = nullptr;
    /// Between two places whose inputs differ little its values may be anything, if
    /// makes_pattern().
    bool is_pattern = false;
};

/// By Blender's bl_idname; nullptr = unknown.
const NodeKind* find_node_kind(const std::string& type);

/// Whether a node of the kind does, by its operation: one that jumps or repeats.
bool makes_pattern(const NodeKind& kind, const Node& node);

}  // namespace granita
