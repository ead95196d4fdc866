// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/lights/light_source.h"

namespace granita {
namespace {

/// Uniform sampling of the solid angle of a rectangle (Urena, Fajardo and King 2013).
class SphericalRectangle {
  public:
    /// Corner region [x0, x1] x [y0, y1] in the plane at depth z0 < 0, seen from the origin.
    SphericalRectangle(double x0, double x1, double y0, double y1, double z0)
        : m_x0(x0), m_x1(x1), m_y0(y0), m_y1(y1), m_z0(z0) {
        const auto unit = [z0](double c) { return c / std::sqrt(c * c + z0 * z0); };
        const double n0 = unit(-y0), n1 = unit(x1), n2 = unit(y1), n3 = unit(-x0);
        // Sines instead of the paper's cosines: the sum of the angles less 2 pi cancels otherwise.
        const double g0 = std::asin(-n0 * n1), g1 = std::asin(-n1 * n2);
        m_g2 = std::asin(-n2 * n3);
        m_g3 = std::asin(-n3 * n0);
        m_b0 = n0;
        m_b1 = n2;
        m_k0 = z0 * z0 / (y0 * y0 + z0 * z0);
        m_solid_angle = -(g0 + g1 + m_g2 + m_g3);
    }

    double solid_angle() const { return m_solid_angle; }

    static constexpr std::size_t kAtOnce = 16;
    /// At most kAtOnce points of the rectangle, relative to the origin.  Loops without branches:
    /// roots and quotients in double precision, two or more at a time (docs/decisions/lighting.md).
    void sample(std::span<const Vec2f> u, std::array<Vec2f, kAtOnce>& points) const {
        std::array<double, kAtOnce> sine, over, along;
        const std::size_t count = u.size();
        for (std::size_t i = 0; i < count; ++i) {
            const double au = u[i].x * m_solid_angle + m_g2 + m_g3;
            sine[i] = std::sin(au);
            over[i] = std::cos(au) * m_b0 + m_b1;
            along[i] = u[i].y;
        }
        for (std::size_t i = 0; i < count; ++i) {
            // The paper's f_u is over / sine, and x = -z0 c / sqrt(1 - c^2) with the cosine c of
            // its azimuth, sgn(f_u) / sqrt(f_u^2 + b0^2): both roots are one.
            const double side2 = over[i] * over[i] - m_k0 * (sine[i] * sine[i]);
            const double signed_sine = over[i] < 0.0 ? -sine[i] : sine[i];
            const double away = -m_z0 * signed_sine / std::sqrt(std::max(side2, kLeast));
            const double x = std::min(std::max(away, m_x0), m_x1);
            const double d2 = x * x + m_z0 * m_z0;
            const double h0 = m_y0 / std::sqrt(d2 + m_y0 * m_y0);
            const double h1 = m_y1 / std::sqrt(d2 + m_y1 * m_y1);
            const double h = h0 + along[i] * (h1 - h0);
            const double up = h * std::sqrt(d2 / std::max(1.0 - h * h, kLeast));
            points[i] = Vec2f(x, std::min(std::max(up, m_y0), m_y1));
        }
    }

  private:
    static constexpr double kLeast = 1e-200;  // of what is cut to the sides, or has no solid angle

    double m_x0, m_x1, m_y0, m_y1, m_z0;
    double m_b0 = 0, m_b1 = 0, m_g2 = 0, m_g3 = 0, m_solid_angle = 0;
    double m_k0 = 0;  ///< 1 - b0^2
};

class AreaLight : public LightSource {
  public:
    AreaLight(const Light& light, const LightFrame& frame)
        : m_center(frame.position),
          m_front(frame.direction),
          m_ellipse(light.shape == AreaShape::Disk || light.shape == AreaShape::Ellipse) {
        const bool one_size = light.shape == AreaShape::Square || light.shape == AreaShape::Disk;
        const Vec3d u = frame.axes[0] * static_cast<double>(light.size.x);
        const Vec3d v = frame.axes[1] * static_cast<double>(one_size ? light.size.x : light.size.y);
        m_half = {0.5f * static_cast<float>(glm::length(u)),
                  0.5f * static_cast<float>(glm::length(v))};
        m_area = 4.0f * m_half.x * m_half.y * (m_ellipse ? 0.25f * kPi : 1.0f);
        if (m_area <= 0.0f) return;
        m_u = Vec3f(glm::normalize(u));
        m_v = Vec3f(glm::normalize(v));
        m_radiance = frame.power * (kInversePi / m_area);
        // A softbox grid whose slats hide light beyond half the spread; the total flux stays.
        const float half_spread = 0.5f * std::clamp(light.spread, kLeastSpread, kPi);
        if (half_spread > 0.5f * kPi - 1e-4f) return;
        m_tan_half = std::tan(half_spread);
        m_spread_scale = half_spread > 0.05f
                             ? 1.0f / (m_tan_half - half_spread)
                             : 3.0f / (half_spread * half_spread * half_spread);  // its series
    }

    bool is_hard() const override { return false; }

    void sample_all(const Vec3f& p, std::span<const Vec2f> u,
                    std::span<LightSample> samples) const override {
        for (LightSample& sample : samples) sample.pdf = 0.0f;
        const Vec3f to_center = m_center - p;
        const float height = -glm::dot(to_center, m_front);
        if (height <= 0.0f || m_area <= 0.0f) return;
        const Vec2f center(glm::dot(to_center, m_u), glm::dot(to_center, m_v));
        Vec2f lo = center - m_half, hi = center + m_half;
        if (!clip_to_spread(height, lo, hi)) return;
        const bool by_area = is_sampled_by_area(lo, hi);
        const auto finish = [&](const Vec2f& q, double solid_angle, LightSample& sample) {
            const Vec3f to_light = q.x * m_u + q.y * m_v - height * m_front;
            const float distance = glm::length(to_light);
            sample.direction = to_light / distance;
            sample.distance = distance;
            if (!shade(solid_angle, sample)) sample.pdf = 0.0f;
        };
        if (by_area) {
            for (std::size_t i = 0; i < u.size(); ++i)
                finish(center + sample_disc(u[i]) * m_half, kByArea, samples[i]);
            return;
        }
        // Once a point: its arcsines and roots take longer than a sample.
        const SphericalRectangle rectangle(lo.x, hi.x, lo.y, hi.y, -height);
        std::array<Vec2f, SphericalRectangle::kAtOnce> q;
        for (std::size_t begin = 0; begin < u.size(); begin += q.size()) {
            const std::size_t count = std::min(q.size(), u.size() - begin);
            rectangle.sample(u.subspan(begin, count), q);
            for (std::size_t i = 0; i < count; ++i)
                if (is_in_shape(q[i] - center))
                    finish(q[i], rectangle.solid_angle(), samples[begin + i]);
        }
    }

    bool intersect(const Vec3f& p, const Vec3f& direction, LightSample& sample) const override {
        const Vec3f to_center = m_center - p;
        const float height = -glm::dot(to_center, m_front);
        const float cos_light = -glm::dot(direction, m_front);
        if (height <= 0.0f || cos_light <= 0.0f || m_area <= 0.0f) return false;
        sample.direction = direction;
        sample.distance = height / cos_light;
        const Vec3f off = direction * sample.distance - to_center;
        if (!is_in_shape(Vec2f(glm::dot(off, m_u), glm::dot(off, m_v)))) return false;
        const Vec2f center(glm::dot(to_center, m_u), glm::dot(to_center, m_v));
        Vec2f lo = center - m_half, hi = center + m_half;
        if (!clip_to_spread(height, lo, hi)) return false;
        double solid_angle = kByArea;
        if (!is_sampled_by_area(lo, hi))
            solid_angle = SphericalRectangle(lo.x, hi.x, lo.y, hi.y, -height).solid_angle();
        return shade(solid_angle, sample);
    }

    bool bound(Vec3f& center, float& radius) const override {
        center = m_center;
        radius = glm::length(m_half);
        return true;
    }

    LightEmission emission() const override {
        LightEmission out;
        const float focus = m_tan_half > 0.0f ? m_tan_half * m_spread_scale : 1.0f;
        out.intensity = mean_size(m_radiance) * focus * m_area;
        out.near2 = m_area * kInversePi;
        out.axis = m_front;
        out.cone = 0.0f;
        out.fall = m_tan_half > 0.0f ? std::atan(m_tan_half) : 0.5f * kPi;
        return out;
    }

  private:
    static constexpr float kLeastSpread = 0.0174533f;  // one degree: narrower is only noise

    static constexpr double kByArea = -1.0;

    /// @param q  from the middle, along the sides.
    bool is_in_shape(const Vec2f& q) const {
        const Vec2f part = glm::abs(q / m_half);
        return m_ellipse ? glm::dot(part, part) <= 1.0f : std::max(part.x, part.y) <= 1.0f;
    }

    /// Only what lies within the spread's circle below the point can send light there.
    bool clip_to_spread(float height, Vec2f& lo, Vec2f& hi) const {
        if (m_tan_half == 0.0f) return true;
        const Vec2f reach(height * m_tan_half);
        lo = glm::max(lo, -reach);
        hi = glm::min(hi, reach);
        return lo.x < hi.x && lo.y < hi.y;
    }

    /// An ellipse is, unless its spread leaves less of it than it is.
    bool is_sampled_by_area(const Vec2f& lo, const Vec2f& hi) const {
        return m_ellipse && (hi.x - lo.x) * (hi.y - lo.y) >= m_area;
    }

    /// `solid_angle`: of the rectangle that is sampled, or kByArea.
    bool shade(double solid_angle, LightSample& sample) const {
        const float cos_light = -glm::dot(sample.direction, m_front);
        if (cos_light <= 0.0f) return false;
        sample.radiance = m_radiance;
        if (m_tan_half > 0.0f) {
            const float tangent =
                std::sqrt(std::max(0.0f, 1.0f - cos_light * cos_light)) / cos_light;
            sample.radiance *= std::max(0.0f, (m_tan_half - tangent) * m_spread_scale);
            if (tangent >= m_tan_half) return false;
        }
        sample.pdf = solid_angle == kByArea
                         ? sample.distance * sample.distance / (cos_light * m_area)
                         : static_cast<float>(1.0 / solid_angle);
        return std::isfinite(sample.pdf) && sample.pdf > 0.0f;
    }

    Vec3f m_center, m_front, m_u{0.0f}, m_v{0.0f};
    Vec2f m_half{0.0f};
    float m_area = 0.0f;
    bool m_ellipse;
    Vec3f m_radiance{0.0f};
    float m_tan_half = 0.0f, m_spread_scale = 1.0f;  ///< tan_half 0 = the whole hemisphere
};

}  // namespace

std::unique_ptr<LightSource> make_area_light(const Light& light, const LightFrame& frame) {
    return std::make_unique<AreaLight>(light, frame);
}

}  // namespace granita
