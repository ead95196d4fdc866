// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "shade/bsdf/lobe.h"

namespace granita {

/// Of Blender's name; MULTI_GGX is GGX whose energy is compensated (Lobe::multiscatter).
inline Distribution distribution_of(const std::string& name) {
    return name == "SHARP"               ? Distribution::Sharp
           : name == "BECKMANN"          ? Distribution::Beckmann
           : name == "ASHIKHMIN_SHIRLEY" ? Distribution::AshikhminShirley
                                         : Distribution::Ggx;
}

}  // namespace granita
