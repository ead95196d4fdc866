// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/surface_run.h"

namespace granita {
namespace {

/// Lobes reflect no less than nothing, as in Cycles; what shines may.
void make_positive(std::vector<Vec3f>& weights) {
    for (Vec3f& weight : weights) weight = glm::max(weight, Vec3f(0.0f));
}

SurfaceClosure closure_of(const Run& run, const SurfaceSources& sources, std::size_t& broken) {
    SurfaceClosure closure;
    for (const LobeSource& from : sources.lobes) {
        Lobe lobe;
        lobe.kind = from.kind;
        lobe.distribution = from.distribution;
        lobe.fresnel = from.fresnel;
        lobe.multiscatter = from.multiscatter;
        lobe.separable_masking = from.separable_masking;
        lobe.smooth_color = from.smooth_color;
        lobe.of_glass = from.of_glass;
        lobe.burley = from.burley;
        lobe.retro_alone = from.retro_alone;
        lobe.deepens_color = from.deepens_color;
        lobe.cosine_bumps = from.cosine_bumps;
        lobe.weight = values_of(run, from.weight);
        broken += make_finite(lobe.weight);
        make_positive(lobe.weight);
        lobe.normal = values_of(run, from.normal);
        lobe.roughness = values_of(run, from.roughness);
        if (from.is_stretched) {
            lobe.tangent = values_of(run, from.tangent);
            lobe.aspect = values_of(run, from.aspect);
        }
        for (const FloatSource& value : from.more) lobe.more.push_back(values_of(run, value));
        lobe.film_spectrum = from.film_spectrum;
        if (from.fresnel != FresnelKind::None || from.has_color) lobe.f0 = values_of(run, from.f0);
        if (from.fresnel != FresnelKind::None) lobe.f90 = values_of(run, from.f90);
        if (from.fresnel == FresnelKind::Dielectric || from.kind == LobeKind::Refraction ||
            from.kind == LobeKind::PrincipledHair)
            lobe.ior = values_of(run, from.ior);
        closure.lobes.push_back(std::move(lobe));
    }
    for (const SubsurfaceSource& from : sources.subsurface) {
        SubsurfaceLobe lobe;
        lobe.walks = from.walks;
        lobe.burley = from.burley;
        lobe.after_diffuse = from.after_diffuse;
        lobe.entry = from.entry;
        lobe.weight = values_of(run, from.weight);
        broken += make_finite(lobe.weight);
        make_positive(lobe.weight);
        lobe.normal = values_of(run, from.normal);
        lobe.albedo = values_of(run, from.albedo);
        lobe.radius = values_of(run, from.radius);
        lobe.anisotropy = values_of(run, from.anisotropy);
        lobe.alpha = values_of(run, from.alpha);
        lobe.ior = values_of(run, from.ior);
        closure.subsurface.push_back(std::move(lobe));
    }
    if (!sources.emission.is(Vec3f(0.0f))) closure.emission = values_of(run, sources.emission);
    if (!sources.transparency.is(Vec3f(0.0f)))
        closure.transparency = values_of(run, sources.transparency);
    return closure;
}

}  // namespace

std::size_t make_finite(std::vector<Vec3f>& values) {
    std::size_t broken = 0;
    for (Vec3f& value : values)
        if (!is_finite(value)) {
            value = Vec3f(0.0f);
            ++broken;
        }
    return broken;
}

SurfaceRun::SurfaceRun(const SurfaceProgram& surface, const ShadingInput& in)
    : m_points(in.points), m_run(surface.program.prepare(in, in.points->count)) {
    surface.program.execute(m_run);
    // Light then knows no other normal, and does not fade as where a node bends one.
    if (surface.is_bumped) {
        m_bent = *in.points;
        m_bent->normal = values_of(m_run, surface.bumped);
    }
    m_closure = closure_of(m_run, surface.sources, m_broken);
}

}  // namespace granita
