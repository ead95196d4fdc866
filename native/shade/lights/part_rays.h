// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shade/bsdf/lobe.h"
#include "shade/rays/ray_type.h"

namespace granita {

/// The types of ray by which parts of light are seen.
struct PartRays {
    RayType diffuse, glossy, transmission;

    RayType of(LightPart part) const {
        return part == LightPart::Diffuse  ? diffuse
               : part == LightPart::Glossy ? glossy
                                           : transmission;
    }
};
constexpr PartRays kBlurred{RayType::Diffuse, RayType::Glossy, RayType::Transmission};
/// Likewise, to the other side of a surface.
constexpr PartRays kBlurredThrough{RayType::Translucent, RayType::Glossy, RayType::Transmission};
constexpr PartRays kSharp{RayType::Diffuse, RayType::Singular, RayType::Clear};
/// Of phase functions, whose light is all transmitted.
constexpr PartRays kScattered{RayType::Scattered, RayType::Scattered, RayType::Scattered};

}  // namespace granita
