// SPDX-License-Identifier: GPL-3.0-or-later
// Tangents of a surface that need no UV map.
#pragma once

#include "shade/programs/node_builder.h"

namespace granita {

enum class RadialAxis { X, Y, Z };

/// Unit, about an axis through the middle of the object's texture space and orthogonal to the
/// shading normal: as brushed metal is turned.  (0, 0, 0) on the axis.
VectorSource radial_tangent(NodeBuilder& b, RadialAxis axis);

}  // namespace granita
