// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace granita {

/// Uniform sampling of the solid angle of a triangle (Arvo 1995).
class SphericalTriangle {
  public:
    /// Corners, seen from the origin.
    SphericalTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c)
        : m_a(glm::normalize(a)), m_b(glm::normalize(b)), m_c(glm::normalize(c)) {
        const Vec3d ab = glm::cross(m_a, m_b), bc = glm::cross(m_b, m_c), ca = glm::cross(m_c, m_a);
        m_alpha = angle(-ca, ab);
        m_solid_angle = std::max(0.0, m_alpha + angle(-ab, bc) + angle(-bc, ca) - kPiD);
        m_cos_c = glm::dot(m_a, m_b);
        m_towards_c = m_c - glm::dot(m_c, m_a) * m_a;
        m_towards_c /= std::max(glm::length(m_towards_c), 1e-300);
    }

    double solid_angle() const { return m_solid_angle; }

    /// A unit direction.
    Vec3d sample(const Vec2f& at) const {
        const double part = static_cast<double>(at.x) * m_solid_angle - m_alpha;
        const double s = std::sin(part), t = std::cos(part);
        const double sin_alpha = std::sin(m_alpha), cos_alpha = std::cos(m_alpha);
        const double u = t - cos_alpha, v = s + sin_alpha * m_cos_c;
        const double below = (v * s + u * t) * sin_alpha;
        const double q =
            below == 0.0 ? 1.0 : std::clamp(((v * t - u * s) * cos_alpha - v) / below, -1.0, 1.0);
        const Vec3d c = q * m_a + std::sqrt(1.0 - q * q) * m_towards_c;
        const double z = 1.0 - static_cast<double>(at.y) * (1.0 - glm::dot(c, m_b));
        const Vec3d across = c - glm::dot(c, m_b) * m_b;
        const double length = glm::length(across);
        if (!(length > 0.0)) return m_b;
        return z * m_b + std::sqrt(std::max(0.0, 1.0 - z * z)) * (across / length);
    }

  private:
    static constexpr double kPiD = 3.14159265358979323846;

    static double angle(const Vec3d& a, const Vec3d& b) {
        return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    }

    Vec3d m_a, m_b, m_c, m_towards_c{0.0};
    double m_alpha, m_solid_angle, m_cos_c;
};

}  // namespace granita
