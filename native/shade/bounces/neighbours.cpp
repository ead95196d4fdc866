// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/neighbours.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace granita {
namespace {

/// Neighbours to each side that a point of a lattice shares with; of separate faces, which lie in
/// Morton order, those before and after.
constexpr std::ptrdiff_t kReach = 6, kRun = 24;
/// Most that their normals are turned away, as 1 - cosine.
constexpr float kBend = 0.25f;
/// Of points that nobody sees, for those that somebody does: where things stand on each other they
/// are inside, in the dark.
constexpr float kHidden = 1e-3f;
/// Of the mean square way to neighbours: slopes that fewer than a line of them tell are none.
constexpr float kRidge = 1e-3f;

/// The plane that fits values around a point best, and its height there.
class PlaneFit {
  public:
    void add(const Vec3f& weight, float x, float y, const Vec3f& value) {
        m_w += weight;
        m_x += weight * x;
        m_y += weight * y;
        m_xx += weight * x * x;
        m_xy += weight * x * y;
        m_yy += weight * y * y;
        m_v += weight * value;
        m_xv += weight * x * value;
        m_yv += weight * y * value;
    }
    /// Not finite of channels that nobody told.
    Vec3f height() const {
        // About the mean place of the neighbours.
        const Vec3f x = m_x / m_w, y = m_y / m_w, mean = m_v / m_w;
        const Vec3f ridge = kRidge * (m_xx + m_yy) + 1e-30f;
        const Vec3f xx = m_xx - x * m_x + ridge, yy = m_yy - y * m_y + ridge;
        const Vec3f xy = m_xy - x * m_y;
        const Vec3f xv = m_xv - m_x * mean, yv = m_yv - m_y * mean;
        const Vec3f determinant = xx * yy - xy * xy;
        const Vec3f along_x = (yy * xv - xy * yv) / determinant;
        const Vec3f along_y = (xx * yv - xy * xv) / determinant;
        return mean - x * along_x - y * along_y;
    }

  private:
    Vec3f m_w{0.0f}, m_x{0.0f}, m_y{0.0f}, m_xx{0.0f}, m_xy{0.0f}, m_yy{0.0f};
    Vec3f m_v{0.0f}, m_xv{0.0f}, m_yv{0.0f};
};

class Sharing {
  public:
    Sharing(const ShadingPoints& points, const NoisyValues& noisy)
        : m_points(points), m_noisy(noisy) {}

    std::vector<Vec3f> run() {
        std::vector<Vec3f> shared = m_noisy.values;
        const auto count = static_cast<std::ptrdiff_t>(m_points.count);
        const auto columns = static_cast<std::ptrdiff_t>(m_points.columns);
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            start(static_cast<std::size_t>(i));
            if (columns == 0) {
                for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(i - kRun, 0);
                     j <= std::min(i + kRun, count - 1); ++j)
                    take(static_cast<std::size_t>(j));
            } else {
                const std::ptrdiff_t x = i % columns, y = i / columns, rows = count / columns;
                for (std::ptrdiff_t v = std::max<std::ptrdiff_t>(y - kReach, 0);
                     v <= std::min(y + kReach, rows - 1); ++v)
                    for (std::ptrdiff_t u = std::max<std::ptrdiff_t>(x - kReach, 0);
                         u <= std::min(x + kReach, columns - 1); ++u)
                        take(static_cast<std::size_t>(v * columns + u));
            }
            const Vec3f height = m_fit.height();
            for (int c = 0; c < 3; ++c)
                if (std::isfinite(height[c]))
                    shared[static_cast<std::size_t>(i)][c] =
                        std::clamp(height[c], m_least[c], m_most[c]);
        }
        return shared;
    }

  private:
    void start(std::size_t i) {
        m_at = i;
        m_fit = {};
        m_least = Vec3f(std::numeric_limits<float>::max());
        m_most = Vec3f(0.0f);
        const float step = std::max(glm::length(m_points.dp_du[i]), glm::length(m_points.dp_dv[i]));
        m_most_by_reach = Vec3f(1.0f / (m_noisy.least_reach * std::max(step, 1e-30f)));
        const Vec3f& normal = m_points.normal[i];
        const Vec3f other = std::abs(normal.x) < 0.7f ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0);
        m_x = glm::normalize(glm::cross(normal, other));
        m_y = glm::cross(normal, m_x);
    }

    void take(std::size_t j) {
        const Vec3f way = m_points.p[j] - m_points.p[m_at];
        // What lies in a narrow place tells nothing of what is outside.
        const Vec3f by_reach =
            glm::min(glm::max(m_noisy.by_reach[m_at], m_noisy.by_reach[j]), m_most_by_reach);
        const Vec3f near = glm::max(1.0f - glm::length(way) * by_reach, Vec3f(0.0f));
        const float bend = 1.0f - glm::dot(m_points.normal[m_at], m_points.normal[j]);
        const float asked = m_points.shares.empty() ? 1.0f : m_points.shares[j];
        const float shown = m_points.seen.empty() || m_points.seen[j] ? 1.0f : kHidden;
        const Vec3f weight =
            asked * shown * std::max(1.0f - bend / kBend, 0.0f) * near * m_noisy.told[j];
        if (weight == Vec3f(0.0f) || !is_finite(m_noisy.values[j])) return;
        m_fit.add(weight, glm::dot(way, m_x), glm::dot(way, m_y), m_noisy.values[j]);
        for (int c = 0; c < 3; ++c) {
            if (!(weight[c] > 0.0f)) continue;
            m_least[c] = std::min(m_least[c], m_noisy.values[j][c]);
            m_most[c] = std::max(m_most[c], m_noisy.values[j][c]);
        }
    }

    const ShadingPoints& m_points;
    const NoisyValues& m_noisy;
    std::size_t m_at = 0;
    Vec3f m_most_by_reach{0.0f};
    Vec3f m_x{0.0f}, m_y{0.0f}, m_least{0.0f}, m_most{0.0f};
    PlaneFit m_fit;
};

}  // namespace

std::vector<Vec3f> share(const ShadingPoints& points, const NoisyValues& noisy) {
    return Sharing(points, noisy).run();
}

}  // namespace granita
