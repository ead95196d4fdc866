// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface program leaves at the points of a grid: scattering lobes, emission and
// transparency.  Node programs write it, lighting (direct_light.h) reads it.  Everything is per
// point, [n]; weights already hold every mix factor, so reflected light is premultiplied by
// opacity.  Directions and normals: world axes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "math/vec.h"
#include "shade/bsdf/subsurface_lobe.h"
#include "shade/bsdf/thin_film.h"

namespace granita {

enum class LobeKind {
    Diffuse,
    Glossy,
    Refraction,  ///< of microfacets: light from the far side
    // Of lobe_shape.h:
    Translucent,   ///< diffuse, from the far side
    ThinGlass,     ///< from the far side of a sheet, straight on; roughness: of both its faces
    Sheen,         ///< roughness
    GrazingSheen,  ///< Principled's before Blender 4
    Velvet,        ///< roughness: the facets' spread
    DiffuseToon,   ///< roughness: size; more[0]: smooth
    GlossyToon,    ///< likewise
    // Of a tube along the tangent; more: radial roughness, offset.
    HairReflection,
    HairTransmission,
    PrincipledHair,  ///< f0: absorption; more[2]: relative roughness of the first reflection;
                     ///< more[3] to [5]: HairForm's cells, aside and tilts_light
    Phase,           ///< of a medium; roughness, more[0]: the two numbers of PhaseKind
};
/// How a Phase lobe sends light on.
enum class PhaseKind : std::uint8_t {
    HenyeyGreenstein,  ///< mean cosine, nothing
    Rayleigh,          ///< nothing
    Draine,            ///< as HenyeyGreenstein's, alpha
    FournierForand,    ///< index, part of the light that goes back
};

/// What lamps, worlds and passes tell apart of the light that a surface sends on.
enum class LightPart { Diffuse, Glossy, Transmission };

constexpr bool transmits(LobeKind kind) {
    return kind == LobeKind::Refraction || kind == LobeKind::Translucent ||
           kind == LobeKind::ThinGlass || kind == LobeKind::HairTransmission ||
           kind == LobeKind::PrincipledHair || kind == LobeKind::Phase;
}
/// Lobes of tubes and media, which send light on to all sides.
constexpr bool sees_all_around(LobeKind kind) {
    return kind == LobeKind::PrincipledHair || kind == LobeKind::Phase;
}
constexpr bool is_of_facets(LobeKind kind) {
    return kind == LobeKind::Glossy || kind == LobeKind::Refraction;
}
/// Lobes that Filter Glossy blurs: of microfacets, and hair's.
constexpr bool is_blurred(LobeKind kind) {
    return is_of_facets(kind) || kind == LobeKind::ThinGlass || kind == LobeKind::PrincipledHair;
}
/// Of lobe_shape.h.
constexpr bool is_shaped(LobeKind kind) {
    return kind > LobeKind::Refraction;
}
/// As Cycles counts them.
constexpr LightPart part_of(LobeKind kind) {
    switch (kind) {
        case LobeKind::Diffuse:
        case LobeKind::Translucent:
        case LobeKind::Sheen:
        case LobeKind::GrazingSheen:
        case LobeKind::DiffuseToon:
            return LightPart::Diffuse;
        case LobeKind::Refraction:
        case LobeKind::ThinGlass:
        case LobeKind::HairTransmission:
        case LobeKind::Phase:
            return LightPart::Transmission;
        default:
            return LightPart::Glossy;
    }
}

enum class Distribution {
    Sharp,
    Beckmann,
    Ggx,
    Gtr1,  ///< Burley's (2012) coat: longer tails, masked as a GGX of roughness 1/2
    AshikhminShirley,
};
enum class FresnelKind {
    None,        ///< weight alone
    Schlick,     ///< f0 + (f90 - f0) (1 - cos)^5 at the half vector
    F82Tint,     ///< Schlick's with f90 = 1, tinted at 82 degrees by f90 (Kutz et al. 2021): metals
    Conductor,   ///< of a complex index, real part f0, imaginary part f90
    Dielectric,  ///< exact, of ior, remapped so that normal incidence gives f0 and grazing f90
                 ///< (Cycles' principled)
};
// Under a thin film Dielectric, F82Tint and Conductor are those of the body below it.
// Refractions pass what their Fresnel does not reflect; None: all but where all is reflected.

struct Lobe {
    LobeKind kind = LobeKind::Diffuse;
    Distribution distribution = Distribution::Ggx;
    FresnelKind fresnel = FresnelKind::None;
    bool multiscatter = false;       ///< glossy: energy compensation as Cycles' MULTI_GGX
    bool separable_masking = false;  ///< glossy: Smith's masking of view and light multiplied, as
                                     ///< Cycles before Blender 4; else height-correlated
    bool smooth_color = false;       ///< glossy: its pass of colour is that of a smooth surface
    bool of_glass = false;           ///< its weight holds glass_compensation(), which passes of
                                     ///< colour do not
    bool burley = false;       ///< diffuse: Burley's (2012) retro-reflection with `roughness`, as
                               ///< Principled before Blender 4
    bool retro_alone = false;  ///< of that what goes back alone
    PhaseKind phase = PhaseKind::HenyeyGreenstein;
    bool deepens_color = false;    ///< diffuse: what bounces inside takes the colour once more than
                                   ///< it should, as in Blender 4.3 to 5.2
    bool cosine_bumps = false;     ///< diffuse: bent normals fade light as before Blender 4.5
    std::vector<Vec3f> weight;     ///< [n]
    std::vector<Vec3f> normal;     ///< [n] unit, facing the viewer as Cycles ensures
    std::vector<float> roughness;  ///< [n] diffuse: Oren-Nayar sigma socket; glossy: the socket's
                                   ///< value (alpha = roughness^2)
    std::vector<float> made;       ///< [n] of multiscatter: the roughness before roughen(), by
                                   ///< which energy is lost; empty or -1: as it is
    std::vector<Vec3f> tangent;    ///< [n] glossy, where alpha differs along it, and of hairs
    std::vector<float> aspect;     ///< [n] alpha / aspect along it, alpha * aspect across
    std::vector<std::vector<float>> more;  ///< [][n] what its kind asks for beside; of microfacets
                                           ///< a thin film's thickness and index, if there is one
    const FilmSpectrum* film_spectrum = nullptr;
    std::vector<Vec3f> f0, f90;  ///< [n] FresnelKind::None and diffuse lobes: f90 empty, f0 empty
                                 ///< or the lobe's colour, which energy compensation saturates
    std::vector<float> ior;  ///< [n] Dielectric and refractions: of the far side relative to the
                             ///< viewer's

    /// Makes a point's facets at least as rough as `least`, an alpha, along the tangent and
    /// across.  Cycles makes up for the energy of lobes before it blurs them, since Blender 4.
    void roughen(std::size_t point, float least) {
        float& value = roughness[point];
        const float alpha = value * value, ratio = aspect.empty() ? 1.0f : aspect[point];
        const float along = std::min(alpha / ratio, 1.0f), across = std::min(alpha * ratio, 1.0f);
        if (multiscatter && !separable_masking) {
            made.resize(roughness.size(), -1.0f);
            if (made[point] < 0.0f) made[point] = std::sqrt(std::sqrt(along * across));
        }
        if (aspect.empty()) {
            value = std::max(value, std::sqrt(least));
            return;
        }
        const float long_way = std::max(along, least), cross_way = std::max(across, least);
        value = std::sqrt(std::sqrt(long_way * cross_way));
        aspect[point] = std::sqrt(cross_way / std::max(long_way, 1e-30f));
    }
};

struct SurfaceClosure {
    std::vector<Lobe> lobes;
    std::vector<SubsurfaceLobe> subsurface;
    std::vector<Vec3f> emission;      ///< [n] radiance, empty = none
    std::vector<Vec3f> transparency;  ///< [n] weight of Transparent closures, empty = none; opacity
                                      ///< = 1 - transparency
};

/// Of light's way from the camera to a point, as Cycles counts it: surfaces that sent it on, by
/// how, and those that let it pass.
struct WayCounts {
    int bounces = 0, diffuse = 0, glossy = 0, transmission = 0, passed = 0;
};

/// The points of a grid in shading space: world axes, origin at the camera (scenes far from the
/// world's origin keep their bits), at the frame time.
struct ShadingPoints {
    std::size_t count = 0;
    std::size_t columns = 0;              ///< points in a row of the grid; 0: all are one row
    std::vector<Vec3f> p;                 ///< [n] camera-relative world
    std::vector<Vec3f> normal;            ///< [n] unit shading normal, faced to the viewer
    std::vector<Vec3f> geometric_normal;  ///< [n] unit, faced to the viewer
    std::vector<Vec3f>
        view;  ///< [n] unit, from the point to the eye (orthographic: the constant direction)
    std::vector<Vec3f> dp_du, dp_dv;  ///< [n] change over one grid step
    /// A pixel's width where they are seen, metres: this much, and this much a metre from the eye.
    float pixel_width = 0.0f, pixel_slope = 0.0f;
    std::vector<Vec3f> ray_offset;     ///< [n] as Grid::ray_offset; may be empty
    std::vector<Vec3f> rise;           ///< [n] as Grid::rise; may be empty
    float terminator_offset = 0.0f;    ///< as Grid::terminator_offset
    std::vector<std::uint32_t> faces;  ///< [n] as ShadingPositions::faces; may be empty
    float share = 1.0f;                ///< as Grid::point_share
    /// The least of `shares`: of points that are not seen.  One of a pixel's 16 samples may see
    /// them after all, through an edge: their noise then counts for a 16th, as much as these ways
    /// are fewer.
    static constexpr float kUnseenShare = 0.125f;
    /// [n] part of that which each is due, of at most three kinds: all, this, and one between them.
    /// Empty: all of it.
    std::vector<float> shares;
    /// [n] 0: hidden from the eye, inside of something or behind it; empty: none is known to be
    std::vector<std::uint8_t> seen;
    bool thicket = false;  ///< much of what is seen lies beside what is hidden
    /// [n] where what moves hides it for a part of the shutter: times at which it does not.  Empty
    /// vectors, or none at all: any time of its life will do.
    std::vector<std::vector<float>> visible_times;
    bool whole_faces = false;  ///< as Grid::shades_faces()
    /// The border may be an edge in which surfaces meet: not that of spheres and hair.
    bool edges = false;
    bool round = false;   ///< of ribbons that stand for tubes, as their normals say
    bool narrow = false;  ///< of ribbons whose samples stand for their whole width each
    bool alone = false;   ///< neighbours tell nothing of each one's light
    std::vector<std::uint8_t> backfacing;  ///< [n]
    /// [n] shutter time at which each is lit, where it then is; negative, or empty: over the whole
    /// shutter.
    std::vector<float> times;
    /// [n] of the rays that see them, metres; empty: from the camera
    std::vector<float> ray_lengths;
    /// [n] what the ways have counted that meet them; empty: none do
    std::vector<WayCounts> counts;
    /// [n] from the eye along the rays that see them, metres; empty: straight
    std::vector<float> seen_from;
    /// How many surfaces, and places in media, lie between them and the camera; of places in media
    /// beyond kDepths, as these share no sequences with what they lie before.
    std::uint32_t depth = 0;
    static constexpr std::uint32_t kDepths = 1u << 16;
    /// [n] in the sample sequences of the frame; empty: in those of the grid, by row and column.
    std::vector<std::uint32_t> places;
    /// [n] as Instance::receives, where points of a batch differ; empty: as the instance has it.
    std::vector<std::uint64_t> receives;
};

}  // namespace granita
