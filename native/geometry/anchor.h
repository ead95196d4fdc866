// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "math/vec.h"

namespace granita {

/// What a point goes along with: the vertex that it is, or, where it stands for whole faces or a
/// place inside one, a place on it and how that is turned and stretched, as neither a corner nor a
/// distance kept to it would follow a body that rotates.
struct Anchor {
    Vec3f place{0.0f};
    Vec3f along{0.0f}, across{0.0f};  ///< edges or diagonals of the face

    Vec3f out() const { return glm::cross(along, across); }
    /// Neither a sliver nor shrunk to one.
    bool is_sound() const {
        constexpr float kSliver = 0.1f;  // sine of the angle between its sides
        const float area = glm::length(out());
        return area > 0.0f && area > kSliver * glm::length(along) * glm::length(across);
    }
};

/// How what is beside an anchor goes along: as the face is stretched, or turned alone where it is a
/// sliver or has shrunk to one.
inline Mat3f carried(const Anchor& from, const Anchor& to) {
    const float before = glm::length(from.out()), after = glm::length(to.out());
    if (!(before > 0.0f && after > 0.0f)) return Mat3f(1.0f);
    const bool sound = from.is_sound() && to.is_sound();
    const auto frame = [&](const Anchor& at, float area) {
        const Vec3f up = at.out() / area;
        if (sound) return Mat3f(at.along, at.across, up * std::sqrt(area));
        const Vec3f ahead = glm::normalize(at.along);
        return Mat3f(ahead, glm::cross(up, ahead), up);
    };
    return frame(to, after) * glm::inverse(frame(from, before));
}

}  // namespace granita
