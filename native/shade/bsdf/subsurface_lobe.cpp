// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/subsurface_lobe.h"

#include <limits>
#include <utility>

#include "shade/bsdf/lobe.h"

namespace granita {

void draw_as_diffuse(SurfaceClosure& closure, bool has_body, bool was_diffuse) {
    constexpr float kLeast = 1e-8f;
    for (SubsurfaceLobe& from : closure.subsurface) {
        const bool scatters = has_body && (from.after_diffuse || !was_diffuse);
        const float radius = scatters ? kLeast : std::numeric_limits<float>::infinity();
        const std::size_t count = from.weight.size();
        Lobe lobe;
        bool any_moves = false, any_stays = false;
        lobe.weight.assign(count, Vec3f(0.0f));
        for (std::size_t i = 0; i < count; ++i)
            for (int c = 0; c < 3; ++c) {
                float& weight = from.weight[i][c];
                if (!(from.radius[i][c] > radius)) std::swap(lobe.weight[i][c], weight);
                any_moves = any_moves || lobe.weight[i][c] != 0.0f;
                any_stays = any_stays || weight != 0.0f;
            }
        if (!any_stays) from.weight.clear();
        if (!any_moves) continue;
        lobe.normal = from.normal;
        lobe.roughness.assign(count, 0.0f);
        closure.lobes.push_back(std::move(lobe));
    }
    std::erase_if(closure.subsurface,
                  [](const SubsurfaceLobe& lobe) { return lobe.weight.empty(); });
}

}  // namespace granita
