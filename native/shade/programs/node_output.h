// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

#include "shade/programs/program.h"

namespace granita {

enum class SocketKind { Number, Color, Vector };

/// A value that a node has produced; `number` for SocketKind::Number, `vector` for the others.
struct NodeOutput {
    SocketKind kind = SocketKind::Number;
    FloatSource number;
    VectorSource vector;
};

using NodeOutputs = std::map<std::string, NodeOutput>;

}  // namespace granita
