// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/sampling.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/microfacet.h"
#include "shade/bsdf/refraction.h"

namespace granita {

/// Direction in which a way enters the medium at a point that is seen from `view`, of the density
/// of what leaves there: nothing need be weighed.  False where none does.
inline bool enter(const SubsurfaceLobe& lobe, std::size_t point, const Vec3f& normal,
                  const Vec3f& view, Vec2f u, Vec3f& direction) {
    SubsurfaceEntry entry = lobe.entry;
    float alpha = lobe.alpha[point];
    if (entry == SubsurfaceEntry::Mixed) {
        entry = u.x < 0.5f ? SubsurfaceEntry::Diffuse : SubsurfaceEntry::Refracted;
        u.x = 2.0f * u.x - (u.x < 0.5f ? 0.0f : 1.0f);
        alpha = 1.0f;
    }
    if (entry == SubsurfaceEntry::Diffuse) {
        direction = Basis(-normal).to_world(sample_cosine_hemisphere(u));
        return true;
    }
    const Basis frame(normal);
    const Vec3f wi = frame.to_local(view);
    if (!(wi.z > 0.0f)) return false;
    const Vec3f half = frame.to_world(sample_ggx_visible(wi, alpha, u));
    return refracted(view, half, lobe.ior[point], direction);
}

}  // namespace granita
