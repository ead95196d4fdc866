// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/told_light.h"

#include <algorithm>
#include <array>

namespace granita {
namespace {

constexpr std::size_t kKinds = 4;
constexpr std::size_t kBelow = 2;  ///< the first of those that are scattered below surfaces

/// Each kind of light, as GridLight orders them; nullptr where there is none of it.
std::array<const NoisyPoints*, kKinds> kinds_of(const ToldLight& told) {
    const auto of = [](const std::optional<NoisyPoints>& points) {
        return points ? &*points : nullptr;
    };
    return {told.gathered ? &told.gathered->all : nullptr,
            told.gathered ? of(told.gathered->world) : nullptr,
            told.scattered ? &told.scattered->direct : nullptr,
            told.scattered ? of(told.scattered->bounced) : nullptr};
}

}  // namespace

std::size_t ToldLight::bytes() const {
    std::size_t bytes = 0;
    for (const NoisyPoints* points : kinds_of(*this)) bytes += points ? points->bytes() : 0;
    return bytes;
}

float ToldLight::reach() const {
    float reach = 0.0f;
    for (const NoisyPoints* points : kinds_of(*this))
        if (points) reach = std::max(reach, points->longest_reach);
    return reach;
}

void share_told(const ShadingPoints& points, const ToldLight& told, const ToldLights& around,
                GridLight& found) {
    const std::array own = kinds_of(told);
    const std::array<std::vector<Vec3f>*, kKinds> shared = {
        &found.gathered, &found.gathered_world, &found.scattered, &found.scattered_bounced};
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        if (!own[kind]) continue;
        if (points.alone && kind < kBelow) {
            *shared[kind] = own[kind]->all_values();
            continue;
        }
        std::vector<const NoisyPoints*> beside;
        for (const auto& other : around)
            if (const NoisyPoints* those = kinds_of(*other)[kind]) beside.push_back(those);
        *shared[kind] = share(points, *own[kind], beside);
    }
}

}  // namespace granita
