// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/mirrored_lamps.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "math/sampling.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/refraction.h"

namespace granita {
namespace {

/// Alphas beyond this make highlights that corners see, but on balls of a pixel or two.
constexpr float kRoughest = 0.15f;
/// What most of a lobe lies within, of its alpha: facets turn what they mirror by twice their lean.
constexpr float kLobeWidth = 4.0f;

/// Of a lobe at a point, along what its facets are stretched by and across.
struct Alphas {
    float least, most;

    Alphas(const Lobe& lobe, std::size_t i) {
        const bool is_sharp = lobe.distribution == Distribution::Sharp;
        const float alpha = is_sharp ? 0.0f : lobe.roughness[i] * lobe.roughness[i];
        const float ratio = lobe.aspect.empty() ? 1.0f : lobe.aspect[i];
        least = std::min(alpha / ratio, alpha * ratio);
        most = std::max(alpha / ratio, alpha * ratio);
    }
};

/// How a point sends the view past a lamp.
struct Pass {
    Vec3f aside{0.0f};  ///< from the lamp's middle, across the way there; about radians
    Vec3f to_lamp{0.0f};
    float margin = 0.0f;  ///< from the middle to where nothing is seen of it any more
    float told = 0.0f;    ///< what is as wide is told by corners so far apart
    bool is_near = false;
};

/// False where nothing is.
bool sent(const Lobe& lobe, const ShadingPoints& points, std::size_t i, Vec3f& way) {
    const Vec3f &normal = lobe.normal[i], &view = points.view[i];
    if (lobe.kind == LobeKind::Refraction) return refracted(view, normal, lobe.ior[i], way);
    way = 2.0f * glm::dot(normal, view) * normal - view;
    return true;
}

Pass pass_of(const Lamp& lamp, const Lobe& lobe, const ShadingPoints& points, std::size_t i,
             float time) {
    Pass pass;
    const Alphas alpha(lobe, i);
    LightSample middle;
    Vec3f way;
    // What has no size is never met, and sharp lobes meet alone.
    if (alpha.least > kRoughest || (lamp.is_hard() && alpha.most <= kSharpAlpha) ||
        lobe.weight[i] == Vec3f(0.0f) || !lamp.exists(time) ||
        !lamp.sample(time, points.p[i], Vec2f(0.5f), middle) || !sent(lobe, points, i, way) ||
        glm::dot(way, middle.direction) <= 0.0f)
        return pass;
    const float radius = lamp.is_hard() ? 0.0f : std::sqrt(kInversePi / middle.pdf);
    pass.to_lamp = middle.direction;
    pass.aside = way - glm::dot(way, middle.direction) * middle.direction;
    pass.told = radius + kLobeWidth * alpha.least;
    // Some lamps' middle sample is not their middle: of a cone it is amid the way to its rim.
    pass.margin = 2.0f * radius + kLobeWidth * alpha.most;
    pass.is_near = true;
    return pass;
}

float distance_to(const Vec2f& a, const Vec2f& b) {
    const Vec2f along = b - a;
    const float length2 = glm::dot(along, along);
    const float t = length2 > 0.0f ? std::clamp(-glm::dot(a, along) / length2, 0.0f, 1.0f) : 0.0f;
    return glm::length(a + t * along);
}

/// Whether the lamp is within a triangle of ways, or near it.
bool meets(const Pass& a, const Pass& b, const Pass& c) {
    if (!a.is_near || !b.is_near || !c.is_near) return false;
    const float margin = std::max({a.margin, b.margin, c.margin});
    const Vec3f low = glm::min(glm::min(a.aside, b.aside), c.aside);
    const Vec3f high = glm::max(glm::max(a.aside, b.aside), c.aside);
    if (largest(low) > margin || largest(-high) > margin) return false;
    const float spread = std::max({glm::distance(a.aside, b.aside), glm::distance(b.aside, c.aside),
                                   glm::distance(c.aside, a.aside)});
    if (spread <= std::min({a.told, b.told, c.told})) return false;
    const Basis basis(a.to_lamp);
    const auto flat = [&](const Pass& pass) { return Vec2f(basis.to_local(pass.aside)); };
    const Vec2f p = flat(a), q = flat(b), r = flat(c);
    const auto cross = [](const Vec2f& u, const Vec2f& v) { return u.x * v.y - u.y * v.x; };
    const float of_pq = cross(p, q), of_qr = cross(q, r), of_rp = cross(r, p);
    const bool is_inside = (of_pq >= 0.0f && of_qr >= 0.0f && of_rp >= 0.0f) ||
                           (of_pq <= 0.0f && of_qr <= 0.0f && of_rp <= 0.0f);
    return is_inside ||
           std::min({distance_to(p, q), distance_to(q, r), distance_to(r, p)}) <= margin;
}

bool is_polished(const Lobe& lobe) {
    if (!is_of_facets(lobe.kind)) return false;
    for (std::size_t i = 0; i < lobe.roughness.size(); ++i)
        if (Alphas(lobe, i).least <= kRoughest) return true;
    return false;
}

/// Whether the lobe's light of the lamp counts.
bool takes(const Lobe& lobe, const Lamp& lamp) {
    BsdfValue value;
    value.part(part_of(lobe.kind)) = Vec3f(1.0f);
    return total(lamp.apply(value, false)) != Vec3f(0.0f);
}

/// A lamp of few whose light a polished lobe mirrors or refracts.
struct Highlight {
    const Lobe& lobe;
    const Lamp& lamp;
};

std::vector<Highlight> highlights_of(const LampSet& set, std::uint64_t receives,
                                     const SurfaceClosure& closure) {
    const std::span<const Lamp> few(set.lamps.data(), set.everywhere);
    std::vector<Highlight> all;
    for (const Lobe& lobe : closure.lobes) {
        if (!is_polished(lobe)) continue;
        for (const Lamp& lamp : few)
            if (lamp.lights(receives) && takes(lobe, lamp)) all.push_back({lobe, lamp});
    }
    return all;
}

}  // namespace

std::vector<std::uint8_t> mirrored_lamps(const LampSet& set, std::uint64_t receives,
                                         const Grid& grid, const ShadingPoints& points,
                                         const SurfaceClosure& closure) {
    std::vector<std::uint8_t> marks;
    std::vector<Pass> passes(points.count);
    for (const auto& [lobe, lamp] : highlights_of(set, receives, closure)) {
        for (std::size_t i = 0; i < points.count; ++i)
            passes[i] = pass_of(lamp, lobe, points, i, set.frame_time);
        for (int m = 0; m < grid.micropolygon_count(); ++m) {
            const Grid::Corners c = grid.corners(m);
            const auto at = [&](int vertex) -> const Pass& {
                return passes[grid.point_at(static_cast<std::size_t>(vertex))];
            };
            if (!meets(at(c.v0), at(c.v1), at(c.v2)) && !meets(at(c.v0), at(c.v2), at(c.v3)))
                continue;
            marks.resize(static_cast<std::size_t>(grid.micropolygon_count()), 0);
            marks[static_cast<std::size_t>(m)] = 1;
        }
    }
    return marks;
}

bool may_mirror_lamps(const LampSet& set, std::uint64_t receives, const SurfaceClosure& closure) {
    return !highlights_of(set, receives, closure).empty();
}

bool lamps_pass(const LampSet& set, std::uint64_t receives, const ShadingPoints& points,
                const SurfaceClosure& closure) {
    for (const auto& [lobe, lamp] : highlights_of(set, receives, closure))
        for (std::size_t i = 0, end; i < points.count; i = end) {
            bool any_meets = false, any_misses = false;
            for (end = i; end < points.count && points.places[end] == points.places[i]; ++end) {
                if (points.times[end] < 0.0f) continue;
                const Pass pass = pass_of(lamp, lobe, points, end, points.times[end]);
                const bool meets = pass.is_near && glm::length(pass.aside) <= pass.margin;
                (meets ? any_meets : any_misses) = true;
            }
            if (any_meets && any_misses) return true;
        }
    return false;
}

}  // namespace granita
