// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shade/programs/surface_builder.h"

namespace granita {

/// `b.text(property)`: Blender's method.  Sets how a lobe is scattered, about which normal, and
/// turns its radius, metres, into what that asks for; its albedo and ior are known.
void set_subsurface_method(NodeBuilder& b, SubsurfaceSource& lobe, const char* property);

}  // namespace granita
