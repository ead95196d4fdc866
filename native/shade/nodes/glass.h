// SPDX-License-Identifier: GPL-3.0-or-later
// What Glass, Refraction and Principled share.
#pragma once

#include "shade/nodes/film.h"

namespace granita {

/// A boundary that reflects and lets through.
struct GlassSource {
    VectorSource weight;           ///< of both
    VectorSource reflected, sent;  ///< colours
    VectorSource normal;
    VectorSource f0;  ///< reflectance at normal incidence
    FloatSource roughness;
    FloatSource ior;  ///< as relative_ior()
    Distribution distribution = Distribution::Ggx;
    bool multiscatter = false;
    FilmSource film;  ///< its index relative to the outside of the body
};

/// The socket's index, at least 1e-5; from behind it is that of leaving the body.
FloatSource relative_ior(NodeBuilder& b, const FloatSource& ior);

/// Reflectance of the smooth boundary along the view.
FloatSource view_fresnel(NodeBuilder& b, const VectorSource& normal, const FloatSource& ior);

/// As Cycles since Blender 4: Fresnel's of each facet.
void add_glass(NodeBuilder& b, SurfaceBuilder& surface, const GlassSource& glass);

/// What makes up for light lost between facets.
VectorSource compensated(NodeBuilder& b, const GlassSource& glass);

}  // namespace granita
