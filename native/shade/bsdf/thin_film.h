// SPDX-License-Identifier: GPL-3.0-or-later
// A film on a surface, a few wavelengths thick: what its two sides reflect interferes, and colours
// the light by its angle (Belcour and Barla 2017, "A Practical Extension to Microfacet Theory for
// the Modeling of Varying Iridescence").
#pragma once

#include "math/vec.h"
#include "shade/bsdf/film_spectrum.h"

namespace granita {

struct ThinFilm {
    float thickness = 0.0f;                  ///< nanometres
    float ior = 1.0f;                        ///< relative to the outside
    const FilmSpectrum* spectrum = nullptr;  ///< of one that is there

    /// Thinner ones are none.
    bool is_there() const { return thickness > 0.1f; }
};

// Reflectances, unpolarised, in [0, 1]; `cosine` of the angle outside.

/// `ior` of the body relative to the outside.
Vec3f film_on_dielectric(const ThinFilm& film, float cosine, float ior);
/// The same where a body reflects `f0` at normal incidence: scaled towards it, the closer it is to
/// what the index alone gives.
Vec3f film_on_dielectric(const ThinFilm& film, float cosine, float ior, const Vec3f& f0);
/// Of a complex index n + i k.
Vec3f film_on_conductor(const ThinFilm& film, float cosine, const Vec3f& n, const Vec3f& k);
/// A metal of F82's colours (fresnel.h); its index is Gulbrandsen's (2014, "Artist Friendly
/// Metallic Fresnel").
Vec3f film_on_metal(const ThinFilm& film, float cosine, const Vec3f& f0, const Vec3f& dip);

}  // namespace granita
