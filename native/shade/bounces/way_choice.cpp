// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/way_choice.h"

#include <algorithm>
#include <cmath>

#include "math/luminance.h"
#include "math/sampling.h"

namespace granita {
namespace {

/// Light samples that a mirror's way must count as to be followed surely, and the part of all that
/// its place sends on from which it is as good as alone.
constexpr float kMuch = 0.32f, kAlone = 0.98f;

/// As much as a way counts of its point's light samples; its place's ways weigh `all` together.
float part(const BouncedPath& path, const Vec3f& weight, float all) {
    return path.sure_part * largest(weight) / std::max(1.0f, all);
}

/// Whether a way is followed without chance; `all`: what the ways from its place weigh together.
/// Mirrors and glass show edges, which are found only in what is in no doubt; and points that
/// happen to show what is improbable would alone be shaded again.  What counts as less than a part
/// of a light sample is left to chance, unless it is all there is: samples that are shaded by
/// themselves, with one each, would follow all that panes and half mirrors make of it
/// (docs/decisions/bounces.md).
bool is_sure(const BouncedPath& path, const Vec3f& weight, float all) {
    return path.kind == BouncedPath::Kind::Mirrored &&
           (part(path, weight, all) >= kMuch || largest(weight) >= kAlone * all);
}

bool is_sure(const BouncedPath& path, const LobeRay& way, float all) {
    return is_sharp(way.ray.type) && is_sure(path, way.weight, all);
}

}  // namespace

void choose_ways(const BouncedPath& path, std::span<const LobeRay> ways, const Vec3f& through,
                 float uniform, std::vector<ChosenWay>& out) {
    out.clear();
    float all = largest(through), in_doubt = 0.0f;
    for (const LobeRay& way : ways) all += largest(way.weight);
    const auto consider = [&](const LobeRay* ray, const Vec3f& weight, bool surely) {
        if (surely)
            out.push_back({ray, weight, part(path, weight, all),
                           path.chance * largest(weight) / all, true, 1.0f});
        else
            in_doubt += largest(weight);
    };
    const bool passes_surely = is_sure(path, through, all);
    consider(nullptr, through, passes_surely);
    for (const LobeRay& way : ways) consider(&way, way.weight, is_sure(path, way, all));
    if (!(in_doubt > 0.0f)) return;
    // Ends more surely the less it can bring: as Cycles, by the root of that.
    const float goes_on =
        std::min(1.0f, std::sqrt(std::max(largest(path.throughput()) * in_doubt, 0.0f)));
    float u = uniform * in_doubt;
    const auto take = [&](const LobeRay* ray, const Vec3f& weight) {
        out.push_back({ray, weight * (in_doubt / largest(weight)), path.sure_part,
                       path.chance * in_doubt / all, false, goes_on});
    };
    if (!passes_surely) {
        if (u < largest(through)) return take(nullptr, through);
        u -= largest(through);
    }
    const LobeRay* taken = nullptr;
    for (const LobeRay& way : ways) {
        if (is_sure(path, way, all)) continue;
        taken = &way;
        if (u < largest(way.weight)) break;
        u -= largest(way.weight);
    }
    if (taken) take(taken, taken->weight);
}

void thin_out(std::vector<LobeRay>& ways, std::uint32_t seed) {
    const auto is_thinned = [](const LobeRay& way) {
        return way.ray.type == RayType::Glossy || way.ray.type == RayType::Transmission;
    };
    auto kept = ways.begin();
    for (auto begin = ways.begin(), end = begin; begin != ways.end(); begin = end) {
        float most = 0.0f;
        for (end = begin; end != ways.end() && end->point == begin->point; ++end)
            most = std::max(most, largest(end->weight));
        std::uint64_t bits = mix_bits(begin->place) + mix_bits(seed);
        for (auto way = begin; way != end; ++way) {
            const float part = largest(way->weight) / most;
            if (is_thinned(*way) && part < 1.0f) {
                bits = mix_bits(bits);
                if (!(unit_float(mix_bits(bits)) < part)) continue;
                way->weight /= part;
            }
            *kept++ = *way;
        }
    }
    ways.erase(kept, ways.end());
}

}  // namespace granita
