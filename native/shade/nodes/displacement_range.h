// SPDX-License-Identifier: GPL-3.0-or-later
// What a displacement's nodes say about it before they are run.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "scene/node_graph.h"

namespace granita {

/// Whether instances of one geometry may be displaced differently: some node that is read looks
/// beyond the geometry.  `read` [nodes] the outputs that something reads.
bool depends_on_instance(const NodeGraph& graph, const std::vector<std::set<std::string>>& read);

/// No displacement is longer, by the ranges of values that nodes give; infinite where they do not
/// tell.  In world space where is_in_world(), else in the object's.
float longest_displacement(const NodeGraph& graph, const std::vector<Image>& images);
bool is_in_world(const NodeGraph& graph);

}  // namespace granita
