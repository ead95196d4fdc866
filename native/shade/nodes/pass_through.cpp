// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that are not evaluated hand on what comes nearest to their result: the value that they
// would change.
#include "shade/nodes/nodes.h"

namespace granita {

/// Edges are sharp.
void build_unbevelled(NodeBuilder& b) {
    b.output_vector("Normal", b.normal_input());
}

}  // namespace granita
