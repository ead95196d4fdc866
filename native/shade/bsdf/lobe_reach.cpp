// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/lobe_reach.h"

#include <algorithm>
#include <cmath>

#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/microfacet.h"
#include "shade/bsdf/refraction.h"

namespace granita {
namespace {

/// Over GGX of the same alpha, at most: where the squared tangent is the squared alpha.
constexpr float kBeckmannPeak = 1.5f;

/// Of an index from 1: what is bent less is as narrow as the view itself, and lamps in it are met
/// by its own samples.
constexpr float kLeastReachBend = 0.05f;

}  // namespace

void DirectionCone::add(const Vec3f& direction) {
    const float cosine = glm::dot(axis, direction);
    if (cosine >= cos) return;
    cos = std::max(cosine, -1.0f);
    sin = std::sqrt(1.0f - cos * cos);
}

void LobeReach::join(const LobeReach& other) {
    normal.add(other.normal.axis);
    mirrored.add(other.mirrored.axis);
    scale = std::max(scale, other.scale);
    alpha2 = std::min(alpha2, other.alpha2);
    long_tail = long_tail && other.long_tail;  // t is at most 1: the other tail is higher
}

/// The facets' normals turn by at least half as much as what they refract, unless the far side is
/// three times less dense, so that what bounds a reflection about the refracted view is a bound
/// here too, once its peak is right.
void PointBsdf::reach_refraction(const Prepared& lobe, LobeReach& reach) const {
    reach.normal.axis = -lobe.normal;
    reach.alpha2 = lobe.alpha * lobe.alpha;
    if (!refracted(m_wi, lobe.normal, lobe.ior, reach.mirrored.axis)) {
        reach.mirrored.axis = -lobe.normal;  // only rough facets let light through: anywhere
        reach.mirrored.cos = -1.0f;
    }
    const float bend = std::max(std::abs(lobe.ior - 1.0f), kLeastReachBend);
    reach.scale =
        mean_size(lobe.weight) * reach.alpha2 * kInversePi * lobe.ior * lobe.ior / (bend * bend);
    if (lobe.distribution == Distribution::Beckmann) reach.scale *= kBeckmannPeak;
}

void PointBsdf::reaches(std::vector<LobeReach>& out) const {
    out.clear();
    for (const Prepared& lobe : m_lobes) {
        if (lobe.sharp) continue;
        LobeReach reach;
        reach.index = lobe.index;
        reach.normal.axis = lobe.normal;
        if (is_shaped(lobe.kind)) {
            if (granita::transmits(lobe.kind)) reach.normal.axis = -lobe.normal;
            reach.glossy_light = part_of(lobe.kind) != LightPart::Diffuse;
            reach.scale = mean_size(lobe.weight) * lobe.shape->peak();
            out.push_back(reach);
            continue;
        }
        if (lobe.kind == LobeKind::Diffuse) {
            reach.scale = mean_size(lobe.weight) * kInversePi;
            out.push_back(reach);
            continue;
        }
        reach.glossy = reach.glossy_light = true;
        if (lobe.kind == LobeKind::Refraction) {
            reach_refraction(lobe, reach);
            out.push_back(reach);
            continue;
        }
        reach.mirrored.axis = 2.0f * lobe.cos_wi * lobe.normal - m_wi;
        reach.alpha2 = lobe.alpha * lobe.alpha;
        // Half vectors lie no farther from the view than half way to the horizon behind.
        const float sin_wi = std::sqrt(std::max(0.0f, 1.0f - lobe.cos_wi * lobe.cos_wi));
        const float farthest = std::sqrt(0.5f * std::max(0.0f, 1.0f - sin_wi));
        const bool ggx = lobe.distribution == Distribution::Ggx;
        const float masking =
            ggx && !lobe.stretched ? 1.0f + ggx_lambda(lobe.alpha, lobe.cos_wi) : 1.0f;
        const Vec3f most = glm::max(fresnel(lobe, 1.0f), fresnel(lobe, farthest));
        reach.scale = mean_size(lobe.weight * most) * (0.25f / (lobe.cos_wi * masking));
        if (lobe.distribution == Distribution::Gtr1 && lobe.alpha < 1.0f) {
            reach.long_tail = true;
            reach.scale *= (reach.alpha2 - 1.0f) / (kPi * std::log(reach.alpha2));
        } else {
            if (lobe.stretched) {  // as wide all around as along its rougher axis
                const float widest = std::max(lobe.alphas.x, lobe.alphas.y);
                reach.scale *= widest * widest / reach.alpha2;
                reach.alpha2 = widest * widest;
            }
            reach.scale *= reach.alpha2 * kInversePi;
            if (lobe.distribution == Distribution::Beckmann) reach.scale *= kBeckmannPeak;
        }
        out.push_back(reach);
    }
}

}  // namespace granita
