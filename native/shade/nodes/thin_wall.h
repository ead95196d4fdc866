// SPDX-License-Identifier: GPL-3.0-or-later
// Principled's Thin Wall (Blender 5.2): a sheet of no thickness, as OpenPBR has it, instead of the
// surface of a body.  Panes do not bend what is seen through them, leaves have no depth.
#pragma once

#include "shade/nodes/glass.h"

namespace granita {

/// `glass.sent`: the colour of what has gone through once at normal incidence; `glass.ior`: of the
/// sheet, from either side.  Its distribution and multiscatter are not asked for, as in Cycles.
void add_thin_glass(NodeBuilder& b, SurfaceBuilder& surface, const GlassSource& glass);
/// Light that is scattered in the sheet, back and through it by its mean cosine; `diffuse`: of all
/// of it.
void add_thin_subsurface(NodeBuilder& b, SurfaceBuilder& surface, LobeSource diffuse,
                         const FloatSource& anisotropy);

}  // namespace granita
