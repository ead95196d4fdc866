// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the light a rough dielectric reflects, between its reflectances at normal and at
// grazing incidence: albedo = f0 + (1 - f0) * dielectric_albedo.  Cycles layers its Principled BSDF
// with a table of the same quantity.
#pragma once

#include "math/vec.h"
#include "shade/bsdf/thin_film.h"

namespace granita {

float ior_from_f0(float f0);

/// The mean over GGX's visible normals (Heitz 2018), weighted by their masking.  From a table made
/// at first use; roughness and cosine in [0, 1].
float dielectric_albedo(float roughness, float cosine, float ior);
/// The cosine-weighted mean of the smooth surface's over all directions.
float dielectric_mean_albedo(float ior);

/// What a layer of Principled BSDF reflects and takes from those below it: `f0` at normal
/// incidence, 1 where it grazes.  With `multiscatter` what is reflected between microfacets too.
/// Under a film it is taken for smooth, as in Cycles.
Vec3f layer_albedo(const Vec3f& f0, float ior, float roughness, float cosine, bool multiscatter,
                   const ThinFilm& film = {});

}  // namespace granita
