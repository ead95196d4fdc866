// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/camera_path.h"

namespace granita {

CameraPath::CameraPath(const Camera& camera) : m_knots(camera.world_from_camera) {
    m_inverses.reserve(m_knots.size());
    for (const Mat4d& knot : m_knots) m_inverses.push_back(glm::inverse(knot));
}

Mat4d CameraPath::camera_from_world(const KnotTime& time) const {
    return matrix_at(m_inverses, time);
}

Mat4d CameraPath::world_from_camera(double time) const {
    if (m_knots.empty()) return Mat4d(1.0);
    const KnotTime at = knot_time(time, static_cast<int>(m_knots.size()));
    const Mat4d& knot = m_knots[at.knot];
    if (at.fraction == 0.0 || knot == m_knots[at.knot + 1]) return knot;
    const Mat4d inverse = camera_from_world(at);
    // Turned by a half from one knot to the next it has none.
    return glm::determinant(inverse) != 0.0 ? glm::inverse(inverse) : matrix_at(m_knots, at);
}

}  // namespace granita
