// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_bound.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// About both axes; angles are halves.
void join_cones(LightBound& a, const LightBound& b) {
    if (a.cone < 0.0f) {
        a.axis = b.axis;
        a.cone = b.cone;
        return;
    }
    const bool wider = a.cone >= b.cone;
    const Vec3f wide = wider ? a.axis : b.axis, narrow = wider ? b.axis : a.axis;
    const float wide_cone = wider ? a.cone : b.cone, narrow_cone = wider ? b.cone : a.cone;
    const Vec3f across = narrow - wide * glm::dot(wide, narrow);
    const float apart = std::atan2(glm::length(across), glm::dot(wide, narrow));
    a.axis = wide;
    a.cone = wide_cone;
    if (std::min(apart + narrow_cone, kPi) <= wide_cone) return;
    a.cone = 0.5f * (wide_cone + apart + narrow_cone);
    if (a.cone >= kPi || !(glm::length(across) > 0.0f)) {
        a.cone = kPi;
        return;
    }
    const float turn = a.cone - wide_cone;
    a.axis = glm::normalize(wide * std::cos(turn) + glm::normalize(across) * std::sin(turn));
}

}  // namespace

void LightBound::join(const LightBound& other) {
    near2 = cone < 0.0f ? other.near2 : std::min(near2, other.near2);
    fall = std::max(fall, other.fall);
    join_cones(*this, other);
    box.add(other.box);
    sets |= other.sets;
}

void LightBound::add(const LightBound& other) {
    join(other);
    diffuse += other.diffuse;
    glossy += other.glossy;
}

void LightBound::add_time(const LightBound& other) {
    join(other);
    diffuse = std::max(diffuse, other.diffuse);
    glossy = std::max(glossy, other.glossy);
}

float LightBound::cost() const {
    if (cone < 0.0f) return 0.0f;
    const Vec3f d = box.hi - box.lo;
    // Points on a line have no surface, but a length; all in one place still have directions.
    const float surface = d.x * d.y + d.y * d.z + d.z * d.x + 1e-3f * glm::dot(d, d);
    const float edge = std::min(cone + fall, kPi);
    const float angle = 2.0f * kPi * (1.0f - std::cos(cone)) +
                        0.5f * kPi *
                            (2.0f * edge * std::sin(cone) - std::cos(cone - 2.0f * edge) -
                             2.0f * cone * std::sin(cone) + std::cos(cone));
    return (diffuse + glossy) * surface * std::max(angle, 1e-3f);
}

}  // namespace granita
