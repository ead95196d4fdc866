// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_receiver.h"

#include <algorithm>

namespace granita {

void LightReceiver::clear() {
    m_box = {};
    m_lobes.clear();
}

void LightReceiver::add(const Bounds3f& reach, const PointBsdf& bsdf) {
    m_box.add(reach);
    bsdf.reaches(m_of_point);
    for (const LobeReach& lobe : m_of_point) {
        const auto same = std::ranges::find(m_lobes, lobe.index, &LobeReach::index);
        if (same == m_lobes.end())
            m_lobes.push_back(lobe);
        else
            same->join(lobe);
    }
}

LightReceiverView LightReceiver::view() const {
    LightReceiverView view{};
    view.radius = 0.5f * glm::length(m_box.hi - m_box.lo);
    for (int k = 0; k < 3; ++k) {
        view.lo[k] = m_box.lo[k];
        view.hi[k] = m_box.hi[k];
        view.middle[k] = 0.5f * (m_box.lo[k] + m_box.hi[k]);
    }
    view.lobes = m_lobes.data();
    view.lobe_count = m_lobes.size();
    return view;
}

}  // namespace granita
