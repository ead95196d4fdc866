// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/lens_knots.h"

#include <algorithm>

#include "base/check.h"

namespace granita {

LensKnots::LensKnots(const std::vector<Vec2d>& knots, Projection& projection) {
    GRANITA_CHECK(!knots.empty());
    Vec2d least = knots.front(), most = knots.front();
    for (const Vec2d& knot : knots) {
        least = glm::min(least, knot);
        most = glm::max(most, knot);
    }
    projection.lens_radius = most.x;
    projection.lens_closing = most.x - least.x;
    projection.focus = least.y;
    projection.focus_travel = most.y - least.y;
    if (!projection.has_lens() || least == most) return;
    m_knots = knots;
    m_widest = projection.lens_radius;
    m_least_inverse = static_cast<float>(1.0 / projection.farthest_focus());
    m_most_inverse = static_cast<float>(1.0 / projection.focus);
}

Vec2d LensKnots::at(float t) const {
    const double place = static_cast<double>(t) * static_cast<double>(m_knots.size() - 1);
    const std::size_t knot = std::min(static_cast<std::size_t>(place), m_knots.size() - 2);
    return glm::mix(m_knots[knot], m_knots[knot + 1], place - static_cast<double>(knot));
}

float LensKnots::inverse_focus(float t) const {
    return std::clamp(static_cast<float>(1.0 / at(t).y), m_least_inverse, m_most_inverse);
}

}  // namespace granita
