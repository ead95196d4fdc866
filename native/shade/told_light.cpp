// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/told_light.h"

#include <algorithm>

namespace granita {
namespace {

/// Of each kind of light that there is.
template <class Visit>
void for_each_kind(const ToldLight& told, const Visit& visit) {
    const auto of = [](const std::optional<NoisyPoints>& points) {
        return points ? &*points : nullptr;
    };
    visit(told.gathered ? &told.gathered->all : nullptr);
    visit(told.gathered ? of(told.gathered->world) : nullptr);
    visit(told.scattered ? &told.scattered->direct : nullptr);
    visit(told.scattered ? of(told.scattered->bounced) : nullptr);
}

}  // namespace

std::size_t ToldLight::bytes() const {
    std::size_t bytes = 0;
    for_each_kind(*this, [&](const NoisyPoints* points) { bytes += points ? points->bytes() : 0; });
    return bytes;
}

float ToldLight::reach() const {
    float reach = 0.0f;
    for_each_kind(*this, [&](const NoisyPoints* points) {
        if (points) reach = std::max(reach, points->longest_reach);
    });
    return reach;
}

void share_told(const ShadingPoints& points, const ToldLight& told, const ToldLights& around,
                GridLight& found) {
    std::vector<const NoisyPoints*> beside[4];
    for (const auto& other : around) {
        std::vector<const NoisyPoints*>* kind = beside;
        for_each_kind(*other, [&](const NoisyPoints* those) {
            if (those) kind->push_back(those);
            ++kind;
        });
    }
    std::vector<Vec3f>* const shared[4] = {&found.gathered, &found.gathered_world, &found.scattered,
                                           &found.scattered_bounced};
    int kind = 0;
    for_each_kind(told, [&](const NoisyPoints* own) {
        const bool scatters = kind >= 2;
        if (own)
            *shared[kind] =
                points.alone && !scatters ? own->all_values() : share(points, *own, beside[kind]);
        ++kind;
    });
}

}  // namespace granita
