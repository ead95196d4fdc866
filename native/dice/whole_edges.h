// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace granita {

class OpenedMesh;

/// [edges] of a subdivision surface: true where an edge is a side of one micropolygon, by what its
/// ends alone tell: short, in the frame, and with normals that turn little.  It is decided for the
/// edge, so that both its faces know; what is false may still turn out whole (EdgeRate::levels).
std::vector<bool> whole_edges(const OpenedMesh& mesh);

}  // namespace granita
