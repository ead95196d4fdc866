// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/vec.h"
#include "shade/bsdf/thin_film.h"

namespace granita {

/// What a layer of Principled BSDF reflects and takes from those below it: `f0` at normal
/// incidence, 1 where it grazes.  With `multiscatter` what is reflected between microfacets too.
/// Under a film it is taken for smooth, as in Cycles.
Vec3f layer_albedo(const Vec3f& f0, float ior, float roughness, float cosine, bool multiscatter,
                   const ThinFilm& film = {});

}  // namespace granita
