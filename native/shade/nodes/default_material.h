// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/node_graph.h"

namespace granita {

/// Blender's look for a slot without a material.
inline NodeGraph default_material() {
    NodeGraph graph;
    Node diffuse{"ShaderNodeBsdfDiffuse", "Default", {}, {}};
    diffuse.inputs["Color"] = Vec4f(0.8f, 0.8f, 0.8f, 1.0f);
    graph.nodes.push_back(std::move(diffuse));
    graph.surface = {0, "BSDF"};
    return graph;
}

}  // namespace granita
