// SPDX-License-Identifier: GPL-3.0-or-later
// Values that instances carry for shaders (Scene::instance_values).
#pragma once

#include "shade/programs/node_builder.h"

namespace granita {

struct InstanceValue {
    VectorSource color;
    FloatSource alpha;
};

/// The instance's four numbers under a key; zeros where the frame has none, and in the world.
InstanceValue instance_value(NodeBuilder& b, const std::string& key);

/// 1 on geometry of a kind, else 0.
FloatSource is_of_kind(NodeBuilder& b, GeometryKind kind);

}  // namespace granita
