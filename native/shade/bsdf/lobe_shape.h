// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes that have a formula and a way to be sampled all of their own, a file each; those of
// microfacets and diffuse ones, which nearly every surface has, are PointBsdf's.
#pragma once

#include <cstddef>
#include <memory>

#include "math/sampling.h"
#include "math/vec.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// Where a lobe is seen from; all unit.
struct LobeView {
    Vec3f wi, normal, geometric_normal;
    float cos_wi;  ///< between the first two
};

/// One thread at a time asks it: it may remember what it was asked for.
class LobeShape {
  public:
    virtual ~LobeShape() = default;
    /// BSDF times cosine, of weight 1, for light that is known to come from there.
    virtual Vec3f evaluate(const Vec3f& wo) const = 0;
    /// Where sample() found the direction.
    virtual Vec3f evaluate_drawn(const Vec3f& wo) const { return evaluate(wo); }
    virtual float pdf(const Vec3f& wo) const = 0;
    /// False when the direction leaves on the wrong side of the lobe's normal.
    virtual bool sample(const Vec2f& u, Vec3f& wo) const = 0;
    /// Share of white light from all sides that leaves along the view, roughly.
    virtual Vec3f albedo() const { return Vec3f(1.0f); }
    /// Of what is drawn along `wo` the part that is mirrored at once; the rest came through.
    virtual float mirrored_part(const Vec3f&) const { return 1.0f; }
    /// Of evaluate() over the cosine, roughly.
    virtual float peak() const { return kInversePi; }
};

/// A hair, or what is as round; lengths of angles are radians.
struct HairForm {
    Vec3f tangent;  ///< unit
    float roughness, radial_roughness, offset;
    float first_roughness = 1.0f;  ///< of the first reflection, relative
    float ior = 1.55f;
    Vec3f sigma{0.0f};  ///< absorption over the radius
    /// Of a ribbon so many cells wide the point stands for that one which lies `aside` of the
    /// middle, on the side to which its normal leans; 0: it is where its normal says.
    float cells = 0.0f, aside = 0.0f;
    bool tilts_light = false;  ///< scales tilt the light's inclination, as in Cycles before
                               ///< Blender 4; else the view's
};

/// Of a kind that is_shaped(); nullptr where there is nothing of it.
std::unique_ptr<const LobeShape> make_shape(const Lobe& lobe, std::size_t point,
                                            const LobeView& view);

// The kinds.
std::unique_ptr<const LobeShape> make_translucent(const LobeView& view);
/// What is seen through a sheet: as a mirror of that roughness would show what is before it.
std::unique_ptr<const LobeShape> make_thin_glass(const LobeView& view, float roughness);
/// Ashikhmin, Premoze and Shirley 2000, "A Microfacet-based BRDF Generator", as velvet.
std::unique_ptr<const LobeShape> make_velvet(const LobeView& view, float sigma);
/// Zeltner, Burley and Chiang 2022, "Practical Multiple-Scattering Sheen Using Linearly Transformed
/// Cosines".
std::unique_ptr<const LobeShape> make_sheen(const LobeView& view, float roughness);
/// Burley 2012: what Principled had before Blender 4.
std::unique_ptr<const LobeShape> make_grazing_sheen(const LobeView& view);
/// Even within an angle about the normal, or the mirrored view; `size` and `smooth` in right
/// angles.
std::unique_ptr<const LobeShape> make_toon(const LobeView& view, bool glossy, float size,
                                           float smooth);
/// Light mirrored by a hair, or sent `through` it.
std::unique_ptr<const LobeShape> make_hair(const LobeView& view, const HairForm& form,
                                           bool through);
std::unique_ptr<const LobeShape> make_principled_hair(const LobeView& view, const HairForm& form);
/// Of a medium: `wi` is where light goes on to; `form` as PhaseKind says.
std::unique_ptr<const LobeShape> make_phase(const LobeView& view, PhaseKind kind,
                                            const Vec2f& form);
/// Ashikhmin and Shirley 2000, "An Anisotropic Phong BRDF Model"; `x`: the direction of alpha.x.
std::unique_ptr<const LobeShape> make_ashikhmin_shirley(const LobeView& view, const Vec3f& x,
                                                        const Vec2f& alpha);

}  // namespace granita
