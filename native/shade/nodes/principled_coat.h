// SPDX-License-Identifier: GPL-3.0-or-later
// The coat of Principled BSDF: a clear varnish over everything else.
//
// Before Blender 4 it lies beside the other lobes, a quarter as strong, with Burley's long tails.
// Since then it takes what it reflects, and what its tint absorbs, from the layers below, their
// emission included.  Since Blender 4.5 it also has what is reflected between its microfacets.
#pragma once

#include "shade/programs/surface_builder.h"

namespace granita {

/// @param weight  of the whole shader, alpha applied
/// @returns what the coat lets through to the layers below
VectorSource add_coat(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight);

}  // namespace granita
