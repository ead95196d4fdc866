// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/volumes/scatter_points.h"

#include <algorithm>

#include "math/luminance.h"
#include "math/sampling.h"

namespace granita {
namespace {

constexpr std::uint32_t kDepths = ShadingPoints::kDepths;

}  // namespace

Vec4f scatter_numbers(std::uint32_t seed, std::uint32_t depth, std::uint32_t place_in_sequence) {
    const std::uint64_t own = mix_bits(seed + (std::uint64_t{kDepths + depth} << 32));
    const SobolPoints points = SobolPoints(own).shuffled(own);
    const float last = unit_float(mix_bits(own + place_in_sequence));
    return {points(place_in_sequence), points.third(place_in_sequence), last};
}

ScatterPoints::ScatterPoints(std::uint32_t depth, int light_samples,
                             const std::set<PhaseKind>& kinds) {
    m_points.depth = kDepths + depth;
    m_points.share = 1.0f / static_cast<float>(std::max(light_samples, 1));
    for (const PhaseKind kind : kinds) {
        Lobe& lobe = m_closure.lobes.emplace_back();
        lobe.kind = LobeKind::Phase;
        lobe.phase = kind;
        lobe.more.emplace_back();
    }
}

void ScatterPoints::add(const Ray& ray, const ScatterPlace& at, std::uint32_t place_in_sequence,
                        float u) {
    ++m_points.count;
    m_points.p.push_back(ray.start + ray.direction * at.distance);
    for (auto* back : {&m_points.view, &m_points.normal, &m_points.geometric_normal})
        back->push_back(-ray.direction);
    m_points.times.push_back(ray.time);
    m_points.places.push_back(place_in_sequence);
    const MediumPhase* taken = nullptr;
    float sum = 0.0f;
    for (const MediumPhase& phase : at.piece->phases) sum += mean_size(phase.scattering);
    float rest = u * sum;
    for (const MediumPhase& phase : at.piece->phases) {
        taken = &phase;
        if (rest < mean_size(phase.scattering)) break;
        rest -= mean_size(phase.scattering);
    }
    m_points.receives.push_back(taken ? taken->receives : ~0ULL);
    for (Lobe& lobe : m_closure.lobes) {
        const bool is_it = taken && lobe.phase == taken->kind;
        lobe.weight.push_back(is_it ? taken->scattering * at.weight *
                                          (sum / mean_size(taken->scattering))
                                    : Vec3f(0.0f));
        lobe.roughness.push_back(is_it ? taken->form.x : 0.0f);
        lobe.more[0].push_back(is_it ? taken->form.y : 0.0f);
    }
}

void ScatterPoints::finish() {
    const std::size_t n = m_points.count;
    m_points.dp_du.assign(n, Vec3f(0.0f));
    m_points.dp_dv.assign(n, Vec3f(0.0f));
    m_points.backfacing.assign(n, 0);
    for (Lobe& lobe : m_closure.lobes) lobe.normal = m_points.normal;
}

}  // namespace granita
