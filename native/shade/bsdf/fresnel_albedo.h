// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the light a rough surface reflects: its albedo is f0 + (f90 - f0) * share of its
// reflectances at normal and at grazing incidence.  Cycles layers its Principled BSDF with tables
// of the same quantity.
#pragma once

namespace granita {

// The mean over GGX's visible normals (Heitz 2018), of which those that mirror the view into the
// surface reflect nothing.  From tables made at first use; roughness and cosine in [0, 1].

float dielectric_share(float roughness, float cosine, float ior);
/// Of Schlick's (1 - cos)^5.
float schlick_share(float roughness, float cosine);

}  // namespace granita
