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

/// Of all samples, those of a texel that is looked at closely; there are few enough of these.
constexpr float kBright = 1e-3f;
/// Of a texel's mean: at least as bright its parts are taken to be.
constexpr double kFloor = 0.02;

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
            Vec3f* radiance = seen;
            for (const RayType ray : kinds(world)) {
                broken += row.add(world, spread, ray, texels, radiance);
                if (radiance) radiance += m_texels_apart;
            }
        }
    });
    m_broken = broken;
    return found;
}

Environment::Environment(const WorldEvaluator& world, const Progress& progress, int height)
    : m_width(2 * height), m_height(height), m_constant(world.is_constant) {
    if (!m_constant) {
        std::vector<float> luminance_of = bake(world, progress);
        build_distribution(luminance_of);
        if (has_density() && !world.is_filtered) build_fine(world, progress, luminance_of);
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
    m_guides.clear();
    m_guides.reserve(static_cast<std::size_t>(m_height) * kGuides);
    std::vector<double> rows(m_height), columns(m_width);
    for (int row = 0; row < m_height; ++row) {
        const float* line = luminance_of.data() + static_cast<std::size_t>(row) * m_width;
        for (int column = 0; column < m_width; ++column) {
            // At least a tenth of the brightest neighbour: what a filtered texture brings across a
            // texel's border is never sampled with far too small a density.  Less of what has been
            // looked at closely.
            double largest = line[column];
            const bool is_known = fine(static_cast<std::size_t>(row) * m_width + column) != nullptr;
            const double least = is_known ? 0.01 : 0.1;
            for (int dy = -1; dy <= 1; ++dy) {
                const int y = std::clamp(row + dy, 0, m_height - 1) - row;
                for (int dx = -1; dx <= 1; ++dx) {
                    const int x = (column + dx + m_width) % m_width;
                    const double l = line[static_cast<std::ptrdiff_t>(y) * m_width + x];
                    largest = std::max(largest, least * l);
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
           (m_guides.size() + m_fine_of.size()) * sizeof(std::uint16_t) +
           m_fine.size() * sizeof(FineTexel) + m_radiance.size() * sizeof(Vec3f);
}

float Environment::part(std::size_t texel) const {
    const auto width = static_cast<std::size_t>(m_width);
    const std::size_t row = texel / width, column = texel % width;
    const float* line = m_columns.data() + row * (width + 1);
    return (m_rows[row + 1] - m_rows[row]) * (line[column + 1] - line[column]);
}

/// A sun of half a degree lies in four texels or more, in part: half of the samples of these missed
/// it, and a floor under a clear sky had .15 of noise at 16 light samples.
void Environment::build_fine(const WorldEvaluator& world, const Progress& progress,
                             std::vector<float>& luminance_of) {
    std::vector<std::size_t> bright;
    for (std::size_t texel = 0; texel < luminance_of.size(); ++texel)
        if (part(texel) > kBright) bright.push_back(texel);
    if (bright.empty()) return;
    m_fine.resize(bright.size());
    m_fine_of.assign(luminance_of.size(), 0);
    parallel_for(bright.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i != end; ++i) {
            progress.check();
            luminance_of[bright[i]] = fill_fine(look_closely(world, bright[i]), m_fine[i]);
            m_fine_of[bright[i]] = static_cast<std::uint16_t>(i + 1);
        }
    });
    build_distribution(luminance_of);
}

/// [kFine + 2][kFine + 2] luminance of the texel's parts and of those around.
std::vector<double> Environment::look_closely(const WorldEvaluator& world,
                                              std::size_t texel) const {
    const auto width = static_cast<std::size_t>(m_width);
    const std::size_t column = texel % width, row = texel / width;
    std::vector<Vec3f> directions, seen;
    for (int y = -1; y <= kFine; ++y)
        for (int x = -1; x <= kFine; ++x)
            directions.push_back(equirectangular_direction(
                (static_cast<double>(column) + (x + 0.5) / kFine) / m_width,
                (static_cast<double>(row) + (y + 0.5) / kFine) / m_height));
    std::vector<double> bright(directions.size(), 0.0);
    for (const RayType ray : kinds(world)) {
        world.radiance(directions, texel_angle() / kFine, ray, seen);
        for (std::size_t i = 0; i < seen.size(); ++i)
            if (is_finite(seen[i])) bright[i] += std::max(0.0f, luminance(seen[i]));
    }
    return bright;
}

/// Returns the mean of what it goes by: at least half of the brightest beside, as a limb may cross
/// what is dark in its middle, and no less than some of all.
float Environment::fill_fine(std::span<const double> bright, FineTexel& fine) {
    constexpr int kRow = kFine + 2;
    const double sum = std::accumulate(bright.begin(), bright.end(), 0.0);
    const double least = std::max(kFloor * sum / (kRow * kRow), 1e-30);
    double columns[kFine], rows[kFine];
    for (int y = 0; y < kFine; ++y) {
        rows[y] = 0.0;
        for (int x = 0; x < kFine; ++x) {
            columns[x] = least;
            for (int dy = 0; dy <= 2; ++dy)
                for (int dx = 0; dx <= 2; ++dx) {
                    const double part = dx == 1 && dy == 1 ? 1.0 : 0.5;
                    const int at = (y + dy) * kRow + x + dx;
                    columns[x] = std::max(columns[x], part * bright[static_cast<std::size_t>(at)]);
                }
            rows[y] += columns[x];
        }
        accumulate(columns, kFine, fine_columns(fine, y));
    }
    accumulate(rows, kFine, fine.data());
    return static_cast<float>(std::accumulate(rows, rows + kFine, 0.0) / (kFine * kFine));
}

float Environment::per_solid_angle(float part, float sine) const {
    part *= static_cast<float>(m_width) * static_cast<float>(m_height);
    return sine > 0.0f ? part / (2.0f * kPi * kPi * sine) : 0.0f;
}

Environment::Sample Environment::sample(const Vec2f& u) const {
    const Located row = locate(m_rows.data(), m_height, u.y, 0, m_height);
    const auto line = static_cast<std::size_t>(row.index);
    const int guide = std::clamp(static_cast<int>(u.x * kGuides), 0, kGuides - 1);
    const std::uint16_t* const guides = m_guides.data() + line * kGuides + guide;
    const Located column = locate(m_columns.data() + line * (m_width + 1), m_width, u.x, guides[0],
                                  guide + 1 < kGuides ? guides[1] + 1 : m_width);
    const std::size_t texel =
        line * static_cast<std::size_t>(m_width) + static_cast<std::size_t>(column.index);
    float chosen = part(texel);
    Vec2f in(column.fraction, row.fraction);
    if (const FineTexel* inside = fine(texel)) {
        const Located y = locate(inside->data(), kFine, in.y, 0, kFine);
        const Located x = locate(fine_columns(*inside, y.index), kFine, in.x, 0, kFine);
        chosen *= x.width * y.width * kFine * kFine;
        in = Vec2f(static_cast<float>(x.index) + x.fraction,
                   static_cast<float>(y.index) + y.fraction) /
             static_cast<float>(kFine);
    }
    const double x = (column.index + static_cast<double>(in.x)) / m_width;
    const double y = (row.index + static_cast<double>(in.y)) / m_height;
    const auto sine = static_cast<float>(std::sin(y * std::numbers::pi));
    return {equirectangular_direction(x, y), per_solid_angle(chosen, sine), texel};
}

Environment::Sample Environment::at(const Vec3f& direction) const {
    if (!has_density()) return {direction, 0.0f, 0};
    const Vec2f p = equirectangular_point(direction);
    const float x = p.x * static_cast<float>(m_width), y = p.y * static_cast<float>(m_height);
    const auto row = static_cast<std::size_t>(std::min(static_cast<int>(y), m_height - 1));
    const auto column = static_cast<std::size_t>(std::min(static_cast<int>(x), m_width - 1));
    const std::size_t texel = row * static_cast<std::size_t>(m_width) + column;
    float chosen = part(texel);
    if (const FineTexel* inside = fine(texel)) {
        const auto place = [](float at, std::size_t first) {
            return std::clamp(static_cast<int>((at - static_cast<float>(first)) * kFine), 0,
                              kFine - 1);
        };
        const int i = place(x, column), j = place(y, row);
        const float* const line = fine_columns(*inside, j);
        chosen *=
            ((*inside)[static_cast<std::size_t>(j) + 1] - (*inside)[static_cast<std::size_t>(j)]) *
            (line[i + 1] - line[i]) * kFine * kFine;
    }
    const float sine = std::sqrt(direction.x * direction.x + direction.y * direction.y);
    return {direction, per_solid_angle(chosen, sine), texel};
}

}  // namespace granita
