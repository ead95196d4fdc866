// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/environment.h"

#include <algorithm>
#include <atomic>
#include <numbers>
#include <numeric>

#include "base/parallel.h"
#include "math/luminance.h"
#include "math/sampling.h"

namespace granita {
namespace {

/// Steps of a row's distribution that are looked up.
constexpr int kGuides = 128;

/// Along a texel's side; the farthest direction from all places is 0.18 of a texel away.
constexpr int kPlaces = 4;

Vec3f equirectangular_direction(double u, double v) {
    const double phi = (2.0 * u - 1.0) * std::numbers::pi, theta = v * std::numbers::pi;
    const double s = std::sin(theta);
    return {static_cast<float>(std::cos(phi) * s), static_cast<float>(std::sin(phi) * s),
            static_cast<float>(std::cos(theta))};
}

Vec2f equirectangular_point(const Vec3f& d) {
    const float u = 0.5f + std::atan2(d.y, d.x) * (0.5f * kInversePi);
    // atan2 keeps its bits near the poles, where acos has none.
    const float v = std::atan2(std::sqrt(d.x * d.x + d.y * d.y), d.z) * kInversePi;
    return {std::clamp(u, 0.0f, 1.0f), std::clamp(v, 0.0f, 1.0f)};
}

/// Running sums of `values` scaled to end at exactly 1; false when all are 0.
bool accumulate(const double* values, int count, float* distribution) {
    const double total = std::accumulate(values, values + count, 0.0);
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        distribution[i] = total > 0.0 ? static_cast<float>(sum / total) : 0.0f;
        sum += values[i];
    }
    distribution[count] = 1.0f;
    return total > 0.0;
}

/// The interval that holds x and where in it.
struct Located {
    int index;
    float fraction, width;
};

/// `first`, `last`: the steps of the distribution between which it lies, both included.
Located locate(const float* distribution, int count, float x, int first, int last) {
    const float* above = std::upper_bound(distribution + first, distribution + last + 1, x);
    const int index = std::clamp(static_cast<int>(above - distribution) - 1, 0, count - 1);
    const float width = distribution[index + 1] - distribution[index];
    const float fraction = width > 0.0f ? (x - distribution[index]) / width : 0.5f;
    return {index, std::clamp(fraction, 0.0f, 0.999999f), width};
}

/// Sums luminance and counts what is not finite, over places that share one lookup.
class TexelRow {
  public:
    /// `side`: places along a texel.  A circle of latitude takes fewer the shorter it is.
    TexelRow(int row, int width, int height, int side) : m_width(width) {
        for (int y = 0; y < side; ++y) {
            const double v = (row + (y + 0.5) / side) / height;
            const int across = std::max(
                1, static_cast<int>(std::ceil(side * std::sin(v * std::numbers::pi) - 1e-6)));
            m_texels.insert(m_texels.end(), static_cast<std::size_t>(across) * width, 0);
            for (int x = 0; x < across * width; ++x) {
                m_texels[m_directions.size()] = x / across;
                m_directions.push_back(equirectangular_direction((x + 0.5) / (across * width), v));
            }
        }
    }
    /// Adds the means of the row's texels to `luminance_of` [width] and, unless it is nullptr,
    /// fills `radiance` [width]; returns how many directions are not finite.
    std::size_t add(const WorldEvaluator& world, float spread, RayType ray, float* luminance_of,
                    Vec3f* radiance) {
        world.radiance(m_directions, spread, ray, m_seen);
        std::vector<double> sum(m_width);
        std::vector<Vec3f> seen(m_width, Vec3f(0.0f));
        std::vector<int> count(m_width);
        std::size_t broken = 0;
        for (std::size_t k = 0; k < m_seen.size(); ++k) {
            const auto texel = static_cast<std::size_t>(m_texels[k]);
            ++count[texel];
            if (is_finite(m_seen[k])) {
                sum[texel] += std::max(0.0f, luminance(m_seen[k]));
                seen[texel] += m_seen[k];
            } else {
                ++broken;
            }
        }
        for (std::size_t x = 0; x < sum.size(); ++x) {
            luminance_of[x] += static_cast<float>(sum[x] / count[x]);
            if (radiance) radiance[x] = seen[x] / static_cast<float>(count[x]);
        }
        return broken;
    }

  private:
    std::size_t m_width;
    std::vector<Vec3f> m_directions, m_seen;
    std::vector<int> m_texels;  ///< [directions]
};

}  // namespace

std::vector<float> Environment::bake(const WorldEvaluator& world, const Progress& progress) {
    const auto width = static_cast<std::size_t>(m_width);
    const int side = world.is_filtered ? 1 : kPlaces;
    const float spread = texel_angle() / static_cast<float>(side);
    std::vector<float> found(width * static_cast<std::size_t>(m_height));
    if (world.is_image) {
        m_texels_apart = world.by_lobe ? found.size() : 0;
        m_radiance.resize(found.size() + (kBlurredRays.size() - 1) * m_texels_apart);
    }
    std::atomic<std::size_t> broken = 0;
    parallel_for(static_cast<std::size_t>(m_height), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y != end; ++y) {
            progress.check();
            TexelRow row(static_cast<int>(y), m_width, m_height, side);
            float* texels = found.data() + width * y;
            Vec3f* const seen = m_radiance.empty() ? nullptr : m_radiance.data() + width * y;
            // One density for all: it is large where any is.
            const std::size_t kinds = world.by_lobe ? kBlurredRays.size() : 1;
            for (std::size_t kind = 0; kind != kinds; ++kind)
                broken += row.add(world, spread, kBlurredRays[kind], texels,
                                  seen ? seen + kind * m_texels_apart : nullptr);
        }
    });
    m_broken = broken;
    return found;
}

Environment::Environment(const WorldEvaluator& world, const Progress& progress, int height)
    : m_width(2 * height), m_height(height), m_constant(world.is_constant) {
    if (!m_constant) {
        build_distribution(bake(world, progress));
        return;
    }
    m_black = true;
    for (const RayType ray : kLightRays) {
        std::vector<Vec3f> seen;
        world.radiance({Vec3f(0.0f, 0.0f, 1.0f)}, 0.0f, ray, seen);
        if (!is_finite(seen[0])) {
            seen[0] = Vec3f(0.0f);
            ++m_broken;
        }
        m_constant_radiance[static_cast<std::size_t>(ray)] = seen[0];
        m_black = m_black && luminance(seen[0]) <= 0.0f;
    }
}

void Environment::build_distribution(const std::vector<float>& luminance_of) {
    m_rows.resize(static_cast<std::size_t>(m_height) + 1);
    m_columns.resize(static_cast<std::size_t>(m_height) * (m_width + 1));
    m_guides.reserve(static_cast<std::size_t>(m_height) * kGuides);
    std::vector<double> rows(m_height), columns(m_width);
    for (int row = 0; row < m_height; ++row) {
        const float* line = luminance_of.data() + static_cast<std::size_t>(row) * m_width;
        for (int column = 0; column < m_width; ++column) {
            // At least a tenth of the brightest neighbour: what a filtered texture brings across a
            // texel's border is never sampled with far too small a density.
            double largest = 0.0;
            for (int dy = -1; dy <= 1; ++dy) {
                const int y = std::clamp(row + dy, 0, m_height - 1) - row;
                for (int dx = -1; dx <= 1; ++dx) {
                    const int x = (column + dx + m_width) % m_width;
                    const double l = line[static_cast<std::ptrdiff_t>(y) * m_width + x];
                    largest = std::max(largest, (dx == 0 && dy == 0) ? l : 0.1 * l);
                }
            }
            columns[column] = largest;
        }
        rows[row] = std::accumulate(columns.begin(), columns.end(), 0.0) *
                    std::sin((row + 0.5) * std::numbers::pi / m_height);
        float* const distribution =
            m_columns.data() + static_cast<std::size_t>(row) * (m_width + 1);
        accumulate(columns.data(), m_width, distribution);
        for (int guide = 0; guide < kGuides; ++guide) {
            const float x = static_cast<float>(guide) / kGuides;
            const float* above = std::upper_bound(distribution, distribution + m_width + 1, x);
            m_guides.push_back(static_cast<std::uint16_t>(
                std::clamp<std::ptrdiff_t>(above - distribution - 1, 0, m_width - 1)));
        }
    }
    if (accumulate(rows.data(), m_height, m_rows.data())) return;
    m_rows.clear();
    m_columns.clear();
    m_guides.clear();
    m_radiance.clear();
}

float Environment::texel_angle() const {
    return kPi / static_cast<float>(m_height);
}

std::size_t Environment::bytes() const {
    return (m_rows.size() + m_columns.size()) * sizeof(float) +
           m_guides.size() * sizeof(std::uint16_t) + m_radiance.size() * sizeof(Vec3f);
}

float Environment::density(int row, int column, float sine) const {
    const float* line = m_columns.data() + static_cast<std::size_t>(row) * (m_width + 1);
    const float part = (m_rows[row + 1] - m_rows[row]) * (line[column + 1] - line[column]) *
                       static_cast<float>(m_width) * m_height;
    return sine > 0.0f ? part / (2.0f * kPi * kPi * sine) : 0.0f;
}

Environment::Sample Environment::sample(const Vec2f& u) const {
    const Located row = locate(m_rows.data(), m_height, u.y, 0, m_height);
    const auto line = static_cast<std::size_t>(row.index);
    const int guide = std::clamp(static_cast<int>(u.x * kGuides), 0, kGuides - 1);
    const std::uint16_t* const guides = m_guides.data() + line * kGuides + guide;
    const Located column = locate(m_columns.data() + line * (m_width + 1), m_width, u.x, guides[0],
                                  guide + 1 < kGuides ? guides[1] + 1 : m_width);
    const float x = (static_cast<float>(column.index) + column.fraction) / m_width;
    const float y = (static_cast<float>(row.index) + row.fraction) / m_height;
    return {equirectangular_direction(x, y), density(row.index, column.index, std::sin(y * kPi)),
            line * m_width + static_cast<std::size_t>(column.index)};
}

Environment::Sample Environment::at(const Vec3f& direction) const {
    if (!has_density()) return {direction, 0.0f, 0};
    const Vec2f p = equirectangular_point(direction);
    const int row = std::min(static_cast<int>(p.y * m_height), m_height - 1);
    const int column = std::min(static_cast<int>(p.x * m_width), m_width - 1);
    const float sine = std::sqrt(direction.x * direction.x + direction.y * direction.y);
    return {direction, density(row, column, sine),
            static_cast<std::size_t>(row) * m_width + static_cast<std::size_t>(column)};
}

}  // namespace granita
