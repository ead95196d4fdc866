// SPDX-License-Identifier: GPL-3.0-or-later
// The lobes of a closure at one point, prepared for evaluation and sampling; Cycles' formulas.
//
//   PointBsdf bsdf(closure, points, i, albedo);
//   value = bsdf.evaluate(direction)                 // f cos, by the parts of light
//   for each lobe: bsdf.sample(lobe, u, direction), bsdf.pdf(lobe, direction)
//
// `wi` is the view direction, `wo` points to the light (Cycles' names); both leave the surface,
// `wo` of lobes that transmit on its far side.
#pragma once

#include <memory>
#include <vector>

#include "math/vec.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/lobe_reach.h"
#include "shade/bsdf/lobe_shape.h"

namespace granita {

class GgxAlbedo;

/// Up to this alpha a lobe is narrower than a pixel of any usual frame (0.2 mrad reflected) and is
/// treated as a mirror.
inline constexpr float kSharpAlpha = 1e-4f;

/// Radiance towards the view per unit radiance and solid angle: BSDF times cosine times weight.
struct BsdfValue {
    Vec3f diffuse{0.0f}, glossy{0.0f}, transmission{0.0f};

    Vec3f& part(LightPart part) {
        return part == LightPart::Diffuse  ? diffuse
               : part == LightPart::Glossy ? glossy
                                           : transmission;
    }
};

inline Vec3f total(const BsdfValue& value) {
    return value.diffuse + value.glossy + value.transmission;
}

inline BsdfValue operator*(const BsdfValue& value, const Vec3f& factor) {
    return {value.diffuse * factor, value.glossy * factor, value.transmission * factor};
}

inline BsdfValue& operator+=(BsdfValue& sum, const BsdfValue& value) {
    sum.diffuse += value.diffuse;
    sum.glossy += value.glossy;
    sum.transmission += value.transmission;
    return sum;
}

class PointBsdf {
  public:
    /// `albedo` is read only for lobes with `multiscatter`.
    PointBsdf(const SurfaceClosure& closure, const ShadingPoints& points, std::size_t point,
              const GgxAlbedo& albedo);

    std::size_t lobe_count() const { return m_lobes.size(); }
    LightPart part(std::size_t lobe) const { return part_of(m_lobes[lobe].kind); }
    /// Whether light comes through the surface; by any lobe.
    bool transmits(std::size_t lobe) const { return granita::transmits(m_lobes[lobe].kind); }
    bool transmits() const { return m_transmits; }
    /// The surface's own shading normal, faced to the viewer.
    const Vec3f& surface_normal() const { return m_normal; }
    /// Of refractions: index of the far side relative to the viewer's.
    float ior(std::size_t lobe) const { return m_lobes[lobe].ior; }
    /// In SurfaceClosure::lobes: those that reflect nothing here are left out.
    std::size_t index(std::size_t lobe) const { return m_lobes[lobe].index; }
    /// A mirror: one direction, no density; evaluate() leaves it out.
    bool is_sharp(std::size_t lobe) const { return m_lobes[lobe].sharp; }
    /// Share of this lobe in the reflected energy, roughly; sums to 1 over the lobes.
    float importance(std::size_t lobe) const { return m_lobes[lobe].importance; }
    /// How likely chance takes a lobe, not what passes straight through.
    float part_of_all() const { return m_part_of_all; }

    /// Share of white light from all sides that leaves along the view, weights included.  Fresnel
    /// is taken at the view's own angle.
    BsdfValue albedo() const;
    /// False where evaluate() is 0 for every direction to the sphere around `to_center`.
    bool can_see(const Vec3f& to_center, float radius) const;
    /// Bounds of the lobes that are not sharp.
    void reaches(std::vector<LobeReach>& out) const;
    /// Sum over all lobes that are not sharp.
    /// `is_drawn`: by sample(), which knows of directions that lamps are not asked for.
    BsdfValue evaluate(const Vec3f& wo, bool is_drawn = false) const;
    /// Density of sample(), per solid angle; 0 for sharp lobes.
    float pdf(std::size_t lobe, const Vec3f& wo) const;
    /// The same, were one sample taken of all lobes: by their importance, but of glass by what the
    /// facets let pass that send it there (Cycles, if it is white), as at angles at which it
    /// mirrors all of the view.
    float chance(std::size_t lobe, const Vec3f& wo) const;
    /// What a sample of the lobe along `wo` counts as, by a number in [0, 1).
    LightPart counted_as(std::size_t lobe, const Vec3f& wo, float uniform) const;
    /// False when the sampled direction leaves on the wrong side of the surface.
    bool sample(std::size_t lobe, const Vec2f& u, Vec3f& wo) const;
    /// Sharp lobes: the mirrored or refracted direction, and the share of the light there that
    /// takes it.  False where there is none.
    bool deflect(std::size_t lobe, Vec3f& wo, Vec3f& share) const;

  private:
    struct Prepared {
        std::size_t index;
        LobeKind kind;
        Distribution distribution;
        FresnelKind fresnel;
        bool sharp = false, separable_masking = false, smooth_color = false, of_glass = false,
             cosine_bumps = false, retro_alone = false;
        Vec3f weight, normal;
        Vec3f f0{1.0f}, f90{1.0f}, dip{0.0f};
        float ior = 1.0f, f0_real = 0.0f;
        ThinFilm film;
        float alpha = 0.0f;
        bool stretched = false;  ///< along x, and then of `alphas`
        Vec3f x{0.0f};
        Vec2f alphas{0.0f};
        float cos_wi = 0.0f;
        float importance = 0.0f;
        float unmet_part = 1.0f;             ///< of refraction's density where no sample of it goes
        float directional_albedo = 1.0f;     ///< without Fresnel; known where energy is compensated
        float burley = -1.0f;                ///< Burley's roughness; < 0 = not his model
        float oren_a = 0.0f, oren_b = 0.0f;  ///< diffuse; b = 0 is Lambert
        Vec3f oren_multiscatter{0.0f};
        std::shared_ptr<const LobeShape> shape;  ///< of kinds that are not of this class
    };

    /// The facets that send light from one direction to the view.
    struct RefractingFacets {
        float half_wi, half_normal;  ///< cosines of their normal to the view and to the lobe's
        float density;
        float jacobian;  ///< solid angle of half vectors per that of directions
        bool are_there;  ///< they bend light that way, and are seen
    };

    // diffuse_lobe.cpp
    void prepare_diffuse(Prepared& lobe, const Lobe& source, std::size_t point) const;
    Vec3f evaluate_diffuse(const Prepared& lobe, const Vec3f& wo) const;
    /// Of a diffuse lobe's light, where its normal is bent.
    float unshadowed(const Prepared& lobe, const Vec3f& wo, bool is_drawn) const;
    // glossy_lobe.cpp
    void prepare_microfacets(Prepared& lobe, float roughness) const;
    void stretch(Prepared& lobe, const Vec3f& tangent, float aspect) const;
    /// Facets that mirror one direction to the view.
    struct MirroringFacets {
        Vec3f half;
        float density, lambda_wi;
    };
    MirroringFacets mirroring_facets(const Prepared& lobe, const Vec3f& wo) const;
    Vec3f local(const Prepared& lobe, const Vec3f& v) const;
    /// `made`: the roughness of which what is lost is made up for.
    void compensate(Prepared& lobe, float made, const GgxAlbedo& albedo) const;
    Vec3f fresnel(const Prepared& lobe, float cos_half) const;
    Vec3f film_fresnel(const Prepared& lobe, float cos_half) const;
    /// What of facets passes of colour show.
    Vec3f seen_part(const Prepared& lobe) const;
    Vec3f evaluate_glossy(const Prepared& lobe, const Vec3f& wo) const;
    float pdf_glossy(const Prepared& lobe, const Vec3f& wo) const;
    // refraction_lobe.cpp
    void prepare_refraction(Prepared& lobe) const;
    Vec3f transmittance(const Prepared& lobe, float cos_half) const;
    bool refracting_facets(const Prepared& lobe, const Vec3f& wo, RefractingFacets& out) const;
    float density_of_refraction(const Prepared& lobe, const RefractingFacets& facets) const;
    Vec3f evaluate_refraction(const Prepared& lobe, const Vec3f& wo) const;
    float pdf_refraction(const Prepared& lobe, const Vec3f& wo) const;
    float chance_of_refraction(const Prepared& lobe, const Vec3f& wo) const;
    void reach_refraction(const Prepared& lobe, LobeReach& reach) const;  // lobe_reach.cpp
    Vec3f evaluate_shape(const Prepared& lobe, const Vec3f& wo, bool is_drawn) const;
    /// Share of the light that facets send the lobe's way.
    Vec3f passed(const Prepared& lobe, float cos_half) const;
    /// Share of it by which chance takes the lobe: what has no Fresnel of its own Cycles takes as
    /// often where none of it passes.
    Vec3f taken(const Prepared& lobe, float cos_half) const;
    /// As sample(), through the surface too.
    bool draw(const Prepared& lobe, const Vec2f& u, Vec3f& wo) const;
    /// Where a facet sends the view.
    bool turn(const Prepared& lobe, const Vec3f& half, Vec3f& wo) const;
    /// Whether a way leaves the face to its own side, or through it.  A tube has a place for each.
    bool leaves(bool through, const Vec3f& wo) const;

    std::vector<Prepared> m_lobes;
    Vec3f m_wi, m_normal, m_geometric_normal;
    bool m_round;                                     ///< as ShadingPoints::round
    float m_part_of_all = 1.0f, m_importance = 0.0f;  ///< of all lobes
    bool m_transmits = false;
};

}  // namespace granita
