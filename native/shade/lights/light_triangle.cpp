// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_triangle.h"

#include <algorithm>
#include <cmath>

#include "math/luminance.h"
#include "math/sampling.h"
#include "scene/knot_time.h"
#include "shade/lights/spherical_triangle.h"

namespace granita {
namespace {

/// Square of the longest edge over that of the distance: the solid angle of an area varies by as
/// much.
constexpr float kFar = 1e-3f;
/// Of single precision.
constexpr float kRounding = 0x1p-20f;

TriangleLight::Corners place(TriangleLight::Corners corners, const Mat4d& matrix) {
    for (Vec3f& corner : corners) corner = Vec3f(transform_point(matrix, Vec3d(corner)));
    return corners;
}

}  // namespace

TriangleLight::TriangleLight(const Corners& corners, const Vec3f& radiance)
    : m_corners(corners), m_radiance(radiance) {
    const Vec3f u = corners[1] - corners[0], v = corners[2] - corners[0], w = v - u;
    m_normal = glm::cross(u, v);
    const float doubled = glm::length(m_normal);
    m_area = 0.5f * doubled;
    if (doubled > 0.0f) m_normal /= doubled;
    m_longest2 = std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(w, w)});
}

bool TriangleLight::is_far(const Vec3f& p) const {
    const Vec3f way = m_corners[0] - p;
    return m_longest2 < kFar * glm::dot(way, way);
}

float TriangleLight::rounding(const Vec3f& p) const {
    const Vec3f size = glm::max(glm::abs(p), glm::abs(m_corners[0]));
    return kRounding * largest(size);
}

float TriangleLight::height(const Vec3f& p) const {
    const float height = glm::dot(m_corners[0] - p, m_normal);
    return std::abs(height) > rounding(p) ? height : 0.0f;
}

void TriangleLight::sample_all(const Vec3f& p, std::span<const Vec2f> u,
                               std::span<LightSample> samples) const {
    for (LightSample& sample : samples) sample.pdf = 0.0f;
    if (!(m_area > 0.0f)) return;
    const float up = height(p);
    if (up == 0.0f) return;
    if (is_far(p)) {
        for (std::size_t i = 0; i < u.size(); ++i) {
            const float root = std::sqrt(u[i].x);
            const Vec3f at = m_corners[0] + root * (1.0f - u[i].y) * (m_corners[1] - m_corners[0]) +
                             root * u[i].y * (m_corners[2] - m_corners[0]);
            const Vec3f way = at - p;
            const float distance = glm::length(way);
            const Vec3f direction = way / distance;
            const float cosine = std::abs(glm::dot(direction, m_normal));
            if (!(cosine > 0.0f)) continue;
            samples[i] = {direction, distance, m_radiance, distance * distance / (cosine * m_area)};
        }
        return;
    }
    const Vec3d from(p);
    const SphericalTriangle seen(Vec3d(m_corners[0]) - from, Vec3d(m_corners[1]) - from,
                                 Vec3d(m_corners[2]) - from);
    const auto pdf = static_cast<float>(1.0 / seen.solid_angle());
    if (!std::isfinite(pdf)) return;
    for (std::size_t i = 0; i < u.size(); ++i) {
        const Vec3f direction(seen.sample(u[i]));
        const float distance = up / glm::dot(direction, m_normal);
        if (!(distance > 0.0f) || !std::isfinite(distance)) continue;
        samples[i] = {direction, distance, m_radiance, pdf};
    }
}

float TriangleLight::crossing(const Corners& corners, const Vec3f& p, const Vec3f& direction) {
    // Moeller and Trumbore 1997.
    const Vec3f u = corners[1] - corners[0], v = corners[2] - corners[0];
    const Vec3f across = glm::cross(direction, v);
    const float volume = glm::dot(u, across);
    if (volume == 0.0f) return 0.0f;
    const Vec3f from = p - corners[0];
    const float a = glm::dot(from, across) / volume;
    const Vec3f other = glm::cross(from, u);
    const float b = glm::dot(direction, other) / volume;
    if (!(a >= 0.0f && b >= 0.0f && a + b <= 1.0f)) return 0.0f;
    const float distance = glm::dot(v, other) / volume;
    return distance > 0.0f ? distance : 0.0f;
}

bool TriangleLight::intersect(const Vec3f& p, const Vec3f& direction, LightSample& sample) const {
    const float distance = crossing(m_corners, p, direction);
    if (distance == 0.0f || height(p) == 0.0f) return false;
    float pdf;
    if (is_far(p)) {
        const float cosine = std::abs(glm::dot(direction, m_normal));
        pdf = distance * distance / (cosine * m_area);
    } else {
        const Vec3d eye(p);
        const SphericalTriangle seen(Vec3d(m_corners[0]) - eye, Vec3d(m_corners[1]) - eye,
                                     Vec3d(m_corners[2]) - eye);
        pdf = static_cast<float>(1.0 / seen.solid_angle());
    }
    sample = {direction, distance, m_radiance, pdf};
    return std::isfinite(pdf) && pdf > 0.0f;
}

bool TriangleLight::bound(Vec3f& center, float& radius) const {
    center = (m_corners[0] + m_corners[1] + m_corners[2]) / 3.0f;
    radius = 0.0f;
    for (const Vec3f& corner : m_corners) radius = std::max(radius, glm::distance(center, corner));
    return true;
}

/// Of a thousand small faces in a row a ray passes a few boxes and a hundred spheres.
Bounds3f TriangleLight::box() const {
    Bounds3f box;
    for (const Vec3f& corner : m_corners) box.add(corner);
    box.grow_relative(kRounding);
    return box;
}

LightEmission TriangleLight::emission() const {
    LightEmission out;
    out.intensity = mean_size(m_radiance) * m_area;
    out.near2 = m_area * kInversePi;
    out.axis = m_normal;
    return out;  // to both sides
}

TriangleLight::Corners MovingTriangle::placed(float time) const {
    const KnotTime t = knot_time(static_cast<double>(time), static_cast<int>(corners.size()));
    TriangleLight::Corners now = corners[t.knot];
    if (t.fraction > 0.0)
        for (std::size_t i = 0; i < 3; ++i)
            now[i] += static_cast<float>(t.fraction) * (corners[t.knot + 1][i] - now[i]);
    return place(now, matrix_at(*from_object, static_cast<double>(time)));
}

void MovingTriangle::at_knots(const std::function<void(const TriangleLight&)>& visit) const {
    for (const Mat4d& matrix : *from_object)
        for (const TriangleLight::Corners& knot : corners) visit({place(knot, matrix), radiance});
}

}  // namespace granita
