// SPDX-License-Identifier: GPL-3.0-or-later
// The lobes of a closure at one point, prepared for evaluation and sampling; Cycles' formulas.
//
//   PointBsdf bsdf(closure, points, i, albedo);
//   value = bsdf.evaluate(direction)                 // f cos, diffuse and glossy apart
//   for each lobe: bsdf.sample(lobe, u, direction), bsdf.pdf(lobe, direction)
//
// `wi` is the view direction, `wo` points to the light (Cycles' names); both leave the surface.
#pragma once

#include <vector>

#include "math/vec.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/lobe_reach.h"

namespace granita {

class GgxAlbedo;

/// Reflected radiance per unit radiance and solid angle: BSDF times cosine times weight.
struct BsdfValue {
    Vec3f diffuse{0.0f}, glossy{0.0f};
};

inline Vec3f total(const BsdfValue& value) {
    return value.diffuse + value.glossy;
}

inline BsdfValue operator*(const BsdfValue& value, const Vec3f& factor) {
    return {value.diffuse * factor, value.glossy * factor};
}

class PointBsdf {
  public:
    /// `albedo` is read only for lobes with `multiscatter`.
    PointBsdf(const SurfaceClosure& closure, const ShadingPoints& points, std::size_t point,
              const GgxAlbedo& albedo);

    std::size_t lobe_count() const { return m_lobes.size(); }
    LobeKind kind(std::size_t lobe) const { return m_lobes[lobe].kind; }
    /// In SurfaceClosure::lobes: those that reflect nothing here are left out.
    std::size_t index(std::size_t lobe) const { return m_lobes[lobe].index; }
    /// A mirror: one direction, no density; evaluate() leaves it out.
    bool is_sharp(std::size_t lobe) const { return m_lobes[lobe].sharp; }
    /// Share of this lobe in the reflected energy, roughly; sums to 1 over the lobes.
    float importance(std::size_t lobe) const { return m_lobes[lobe].importance; }

    /// Share of white light from all sides that leaves along the view, weights included.  Fresnel
    /// of glossy lobes is taken at the view's own angle.
    BsdfValue albedo() const;
    /// False where evaluate() is 0 for every direction to the sphere around `to_center`.
    bool can_see(const Vec3f& to_center, float radius) const;
    /// Bounds of the lobes that are not sharp.
    void reaches(std::vector<LobeReach>& out) const;
    /// Sum over all lobes that are not sharp.
    BsdfValue evaluate(const Vec3f& wo) const;
    /// Density of sample(), per solid angle; 0 for sharp lobes.
    float pdf(std::size_t lobe, const Vec3f& wo) const;
    /// False when the sampled direction leaves through the surface.
    bool sample(std::size_t lobe, const Vec2f& u, Vec3f& wo) const;
    /// Sharp lobes: the mirror direction and the reflectance along it.
    bool reflect(std::size_t lobe, Vec3f& wo, Vec3f& reflectance) const;

  private:
    struct Prepared {
        std::size_t index;
        LobeKind kind;
        Distribution distribution;
        FresnelKind fresnel;
        bool sharp = false, separable_masking = false, cosine_bumps = false;
        Vec3f weight, normal;
        Vec3f f0{1.0f}, f90{1.0f}, dip{0.0f};
        float ior = 1.0f, f0_real = 0.0f;
        float alpha = 0.0f;
        float cos_wi = 0.0f;
        float importance = 0.0f;
        float directional_albedo = 1.0f;     ///< without Fresnel; known where energy is compensated
        float burley = -1.0f;                ///< Burley's roughness; < 0 = not his model
        float oren_a = 0.0f, oren_b = 0.0f;  ///< diffuse; b = 0 is Lambert
        Vec3f oren_multiscatter{0.0f};
    };

    Vec3f fresnel(const Prepared& lobe, float cos_half) const;
    Vec3f evaluate_diffuse(const Prepared& lobe, const Vec3f& wo) const;
    Vec3f evaluate_glossy(const Prepared& lobe, const Vec3f& wo) const;
    void prepare_diffuse(Prepared& lobe, const Vec3f* color, float roughness) const;
    void prepare_glossy(Prepared& lobe, float roughness, bool multiscatter,
                        const GgxAlbedo& albedo) const;

    std::vector<Prepared> m_lobes;
    Vec3f m_wi, m_normal, m_geometric_normal;
};

}  // namespace granita
