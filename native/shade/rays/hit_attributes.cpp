// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/hit_attributes.h"

#include <algorithm>

#include "geometry/surface_evaluator.h"

namespace granita {

void HitAttributes::resize(const std::vector<AttributeRequest>& requests, std::size_t n) {
    m_attributes.resize(requests.size());
    for (std::size_t k = 0; k < requests.size(); ++k) {
        GridAttribute& attribute = m_attributes[k];
        attribute.attribute = static_cast<int>(k);
        attribute.width = requests[k].width;
        const std::size_t size = n * static_cast<std::size_t>(requests[k].width);
        attribute.values.assign(size, 0.0f);
        attribute.du.assign(requests[k].derivatives ? size : 0, 0.0f);
        attribute.dv.assign(requests[k].derivatives ? size : 0, 0.0f);
    }
}

void HitAttributes::fill(std::size_t i, const RayHit& hit,
                         const std::vector<AttributeRequest>& requests,
                         const std::optional<Vec2f>& steps) {
    for (std::size_t k = 0; k < requests.size(); ++k) {
        GridAttribute& to = m_attributes[k];
        const auto width = static_cast<std::size_t>(requests[k].width);
        float* const values = &to.values[i * width];
        if (hit.elements) {
            element_value(*hit.elements, requests[k], hit.place, values);
            continue;
        }
        hit.geometry->surface().attribute(*hit.patch, requests[k], {&hit.uv, 1}, m_values, m_du,
                                          m_dv);
        std::copy_n(m_values.begin(), width, values);
        for (std::size_t c = 0; steps && c < width && !to.du.empty(); ++c) {
            to.du[i * width + c] = m_du[c] * steps->x;
            to.dv[i * width + c] = m_dv[c] * steps->y;
        }
    }
}

}  // namespace granita
