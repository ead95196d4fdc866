// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <string>

#include "shade/programs/node_builder.h"
#include "shade/rays/ray_type.h"

namespace granita {

/// What an output of Light Path is for all rays of a type; Ray Length, which differs from ray to
/// ray, is 0, and depths are those of rays that surfaces send which the camera itself sees.
float light_path_value(const std::string& output, RayType ray);

/// Whether any of these outputs of Light Path differs between two types of ray.
bool told_apart(const std::set<std::string>& outputs, RayType a, RayType b);

/// Whether anything in a graph may depend on how long rays are.
bool reads_ray_length(const NodeGraph& graph);

/// From where the ray started that meets the point, metres; 0 in the world.
FloatSource ray_length(NodeBuilder& b);

}  // namespace granita
