// SPDX-License-Identifier: GPL-3.0-or-later
// Four neighbours side by side, on every processor: the bits are the same.
#include "shade/bounces/neighbours.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shade/lights/leaving_rays.h"

namespace granita {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr hn::FixedTag<float, 4> kTag;
using V = hn::Vec<decltype(kTag)>;

/// Neighbours to each side that a point of a lattice shares with; of separate faces, which lie in
/// Morton order, those before and after.
constexpr std::size_t kReach = 8, kRun = 64;
/// Most that their normals are turned away, as 1 - cosine.
constexpr float kBend = 0.25f;
/// Of points that nobody sees, for those that somebody does: where things stand on each other they
/// are inside, in the dark.  Far less than kRidge, or slopes towards them would be told by them: a
/// floor's last pixel before a wall was up to 17 % too dark.
constexpr float kHidden = 1e-6f;
/// Of the mean square way to neighbours: slopes that fewer than a line of them tell are none.
constexpr float kRidge = 1e-3f;

V set(float value) {
    return hn::Set(kTag, value);
}

std::array<float, 4> lanes(V values) {
    std::array<float, 4> each;
    hn::StoreU(values, kTag, each.data());
    return each;
}

float sum(V values) {
    const auto [a, b, c, d] = lanes(values);
    return (a + b) + (c + d);
}

/// A number of each point, behind the last of which there is room to read.
struct Column {
    std::vector<float> values;

    template <class Value>
    Column(std::size_t count, Value value) : values(count + hn::Lanes(kTag) - 1) {
        for (std::size_t i = 0; i < count; ++i) values[i] = value(i);
    }
    V at(std::size_t j) const { return hn::LoadU(kTag, values.data() + j); }
    float operator[](std::size_t i) const { return values[i]; }
};

/// Where neighbours lie around a point, by weight.
struct Spread {
    V w = set(0), ww = w, x = w, y = w, xx = w, xy = w, yy = w;

    void add(V weight, V at_x, V at_y) {
        const V wx = weight * at_x, wy = weight * at_y;
        w += weight;
        ww += weight * weight;
        x += wx;
        y += wy;
        xx += wx * at_x;
        xy += wx * at_y;
        yy += wy * at_y;
    }
};

/// What they say of a channel.
struct Heights {
    V v = set(0), vv = v, xv = v, yv = v;
    V least = set(std::numeric_limits<float>::max()), most = v;

    void add(V weight, V at_x, V at_y, V value) {
        const V weighed = weight * value;
        v += weighed;
        vv += weighed * value;
        xv += weighed * at_x;
        yv += weighed * at_y;
        const auto counts = hn::Gt(weight, set(0));
        least = hn::Min(least, hn::IfThenElse(counts, value, least));
        most = hn::Max(most, hn::IfThenElse(counts, value, most));
    }
    /// Of the plane that fits best, between the least and the most of them.  Not finite where
    /// nobody told.
    float fit(const Spread& spread) const {
        // About the mean place of the neighbours.
        const float w = sum(spread.w), sum_x = sum(spread.x), sum_y = sum(spread.y);
        const float x = sum_x / w, y = sum_y / w, mean = sum(v) / w;
        const float x2 = sum(spread.xx), y2 = sum(spread.yy);
        const float ridge = kRidge * (x2 + y2) + 1e-30f;
        const float xx = x2 - x * sum_x + ridge, yy = y2 - y * sum_y + ridge;
        const float xy = sum(spread.xy) - x * sum_y;
        const float along_x = sum(xv) - sum_x * mean, along_y = sum(yv) - sum_y * mean;
        const float determinant = xx * yy - xy * xy;
        const float slope_x = (yy * along_x - xy * along_y) / determinant;
        const float slope_y = (xx * along_y - xy * along_x) / determinant;
        // Noise has slopes too, and where neighbours lie to one side a plane's end has seven times
        // the variance of their mean.  What is left of the slopes is as much as noise alone would
        // not explain (an empirical Bayes estimate: Efron and Morris 1975).
        const float explained = slope_x * along_x + slope_y * along_y;
        const float noise = std::max(sum(vv) - w * mean * mean - explained, 0.0f) / w;
        const float by_noise = 2.0f * noise * sum(spread.ww) / w;
        const float kept = explained > by_noise ? 1.0f - by_noise / explained : 0.0f;
        const float height = mean - kept * (x * slope_x + y * slope_y);
        if (!std::isfinite(height)) return height;
        return std::clamp(height, std::ranges::min(lanes(least)), std::ranges::max(lanes(most)));
    }
};

class Sharing {
  public:
    Sharing(const ShadingPoints& points, const NoisyValues& noisy)
        : m_points(points),
          m_noisy(noisy),
          m_p(columns(points.p)),
          m_normal(columns(points.normal)),
          m_asked(points.count, [&](std::size_t i) { return asked(i); }),
          m_by_reach(columns(noisy.by_reach)),
          m_told(columns(noisy.told)),
          m_values(columns(noisy.values)) {
        const auto is_grey = [](const Vec3f& v) { return v.x == v.y && v.x == v.z; };
        if (std::ranges::all_of(noisy.by_reach, is_grey) &&
            std::ranges::all_of(noisy.told, is_grey))
            m_channels_apart = 0;
    }

    std::vector<Vec3f> run() {
        std::vector<Vec3f> shared = m_noisy.values;
        const std::size_t count = m_points.count, columns = m_points.columns;
        const auto before = [](std::size_t at, std::size_t reach) {
            return at - std::min(at, reach);
        };
        for (std::size_t i = 0; i < count; ++i) {
            start(i);
            if (columns == 0) {
                take(before(i, kRun), std::min(i + kRun + 1, count));
            } else {
                const std::size_t x = i % columns, y = i / columns, rows = count / columns;
                const auto [top, bottom] = window(y, rows);
                const auto [left, right] = window(x, columns);
                for (std::size_t v = top; v < bottom; ++v)
                    take(v * columns + left, v * columns + right);
            }
            for (std::size_t c = 0; c < 3; ++c) {
                const float height = m_heights[c].fit(m_spreads[c * m_channels_apart]);
                if (std::isfinite(height)) shared[i][static_cast<int>(c)] = height;
            }
        }
        return shared;
    }

  private:
    using Columns = std::array<Column, 3>;

    static Columns columns(const std::vector<Vec3f>& of) {
        const auto channel = [&](int c) {
            return Column(of.size(),
                          [&, c](std::size_t i) { return is_finite(of[i]) ? of[i][c] : 0.0f; });
        };
        return {channel(0), channel(1), channel(2)};
    }
    /// As many on each line of a lattice: at its end those of the one side.
    static std::pair<std::size_t, std::size_t> window(std::size_t at, std::size_t count) {
        const std::size_t size = std::min(2 * kReach + 1, count);
        const std::size_t first = std::min(at - std::min(at, kReach), count - size);
        return {first, first + size};
    }
    static V dot(const std::array<V, 3>& a, const Vec3f& b) {
        return a[0] * set(b.x) + a[1] * set(b.y) + a[2] * set(b.z);
    }

    float asked(std::size_t i) const {
        if (!is_finite(m_noisy.values[i])) return 0.0f;
        return (m_points.shares.empty() ? 1.0f : m_points.shares[i]) *
               (m_points.seen.empty() || m_points.seen[i] ? 1.0f : kHidden);
    }

    void start(std::size_t i) {
        m_at = i;
        m_spreads = {};
        m_heights = {};
        const float step = width_of(m_points, i);
        m_most_by_reach = 1.0f / (m_noisy.least_reach * std::max(step, 1e-30f));
        const Vec3f& normal = m_points.normal[i];
        const Vec3f other = std::abs(normal.x) < 0.7f ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0);
        m_x = glm::normalize(glm::cross(normal, other));
        m_y = glm::cross(normal, m_x);
    }

    void take(std::size_t first, std::size_t last) {
        const auto of = [](const Columns& columns, std::size_t j) {
            return std::array{columns[0].at(j), columns[1].at(j), columns[2].at(j)};
        };
        const Vec3f& p = m_points.p[m_at];
        for (std::size_t j = first; j < last; j += hn::Lanes(kTag)) {
            std::array<V, 3> way = of(m_p, j);
            for (int c = 0; c < 3; ++c) way[c] -= set(p[c]);
            const V distance = hn::Sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
            const V x = dot(way, m_x), y = dot(way, m_y);
            const V bend = set(1.0f) - dot(of(m_normal, j), m_points.normal[m_at]);
            const V alike = hn::Max(set(1.0f) - bend / set(kBend), set(0.0f));
            const V asked = hn::IfThenElseZero(hn::FirstN(kTag, last - j), m_asked.at(j) * alike);
            std::array<V, 3> weights;
            for (std::size_t c = 0; c < 3; ++c) {
                if (c == 0 || m_channels_apart) {
                    // What lies in a narrow place tells nothing of what is outside.
                    const V by_reach =
                        hn::Min(hn::Max(set(m_by_reach[c][m_at]), m_by_reach[c].at(j)),
                                set(m_most_by_reach));
                    const V near = hn::Max(set(1.0f) - distance * by_reach, set(0.0f));
                    weights[c] = asked * near * m_told[c].at(j);
                    m_spreads[c].add(weights[c], x, y);
                } else {
                    weights[c] = weights[0];
                }
                m_heights[c].add(weights[c], x, y, m_values[c].at(j));
            }
        }
    }

    const ShadingPoints& m_points;
    const NoisyValues& m_noisy;
    Columns m_p, m_normal;
    Column m_asked;
    Columns m_by_reach, m_told, m_values;
    std::size_t m_channels_apart = 1;  ///< 0: all have the same neighbours
    std::size_t m_at = 0;
    float m_most_by_reach = 0.0f;
    Vec3f m_x{0.0f}, m_y{0.0f};
    std::array<Spread, 3> m_spreads;
    std::array<Heights, 3> m_heights;
};

}  // namespace

std::vector<Vec3f> share(const ShadingPoints& points, const NoisyValues& noisy) {
    return Sharing(points, noisy).run();
}

}  // namespace granita
