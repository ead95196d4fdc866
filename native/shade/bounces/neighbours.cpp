// SPDX-License-Identifier: GPL-3.0-or-later
// Four neighbours side by side, on every processor: the bits are the same.
#include "shade/bounces/neighbours.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "shade/lights/leaving_rays.h"

namespace granita {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr hn::FixedTag<float, 4> kTag;
using V = hn::Vec<decltype(kTag)>;

/// Of separate faces, which lie in Morton order, those before and after a point that it shares
/// with.
constexpr std::size_t kRun = 64;
/// Steps of the grid: what varies slower than that is found at every second point.
constexpr float kSlowly = 6.0f;
/// Points of other grids, or so: twice as many as lie around one of a lattice.  Where a ball has
/// its pole, or a cone its tip, a point's reach holds thousands.
constexpr std::size_t kEnough = 512;
/// Most that their normals are turned away, as 1 - cosine.
constexpr float kBend = 0.25f;
/// The same of points between which others are interpolated: not across creases.
constexpr float kBendBetween = 0.05f;
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

V at(const NoisyPoints::Column& column, std::size_t j) {
    return hn::LoadU(kTag, column.data() + j);
}

std::array<V, 3> at(const NoisyPoints::Columns& columns, std::size_t j) {
    return {at(columns[0], j), at(columns[1], j), at(columns[2], j)};
}

NoisyPoints::Columns columns_of(const std::vector<Vec3f>& of) {
    NoisyPoints::Columns columns;
    for (int c = 0; c < 3; ++c)
        for (const Vec3f& v : of) columns[c].push_back(is_finite(v) ? v[c] : 0.0f);
    return columns;
}

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

Vec3f place(const NoisyPoints& points, std::size_t j) {
    return {points.p[0][j], points.p[1][j], points.p[2][j]};
}

bool is_within(const Bounds3f& box, const Vec3f& p, float reach) {
    const Vec3f way = glm::max(glm::max(box.lo - p, p - box.hi), Vec3f(0.0f));
    return glm::dot(way, way) < reach * reach;
}

/// Points that follow each other, and lie beside each other.
struct Run {
    std::size_t begin = 0, end = 0;
    Bounds3f box{};
};

/// What one of the grids around tells.
struct Beside {
    const NoisyPoints* points;
    Bounds3f box{};  ///< of all runs
    std::vector<Run> runs{};
};

/// Where the points of a grid lie.
class Places {
  public:
    explicit Places(const NoisyPoints& points) {
        m_sorted.reserve(points.count);
        for (std::size_t j = 0; j < points.count; ++j)
            m_sorted.push_back(as_array(place(points, j)));
        std::ranges::sort(m_sorted);
    }
    bool hold(const Vec3f& p) const { return std::ranges::binary_search(m_sorted, as_array(p)); }

  private:
    static std::array<float, 3> as_array(const Vec3f& p) { return {p.x, p.y, p.z}; }

    std::vector<std::array<float, 3>> m_sorted;
};

/// Of the grids around one, the points within its reach, but for those of their borders that are
/// its own: where a wall stands on that border, they lie on the other side of it.
std::vector<Beside> beside(const NoisyPoints& own, std::span<const NoisyPoints* const> grids) {
    // Of more the most are too far from any one point.
    constexpr std::size_t kRunLength = 16;
    Bounds3f wide = own.box;
    wide.grow(own.longest_reach);
    std::vector<Beside> all;
    std::optional<Places> own_places;
    for (const NoisyPoints* grid : grids) {
        Beside found{grid};
        for (std::size_t j = 0; j < grid->count; ++j) {
            const Vec3f p = place(*grid, j);
            if (grid->asked[j] == 0.0f || !wide.holds(p)) continue;
            if (own.box.holds(p)) {
                if (!own_places) own_places.emplace(own);
                if (own_places->hold(p)) continue;
            }
            const bool goes_on =
                !found.runs.empty() && found.runs.back().end == j && j % kRunLength != 0;
            if (!goes_on) found.runs.push_back({j, j});
            found.runs.back().end = j + 1;
            found.runs.back().box.add(p);
            found.box.add(p);
        }
        if (!found.runs.empty()) all.push_back(std::move(found));
    }
    return all;
}

class Sharing {
  public:
    Sharing(const ShadingPoints& points, const NoisyPoints& own,
            std::span<const NoisyPoints* const> around)
        : m_points(points), m_own(own), m_beside(beside(own, around)) {
        const auto is_grey = [](const Beside& grid) { return grid.points->is_grey; };
        if (own.is_grey && std::ranges::all_of(m_beside, is_grey)) m_channels_apart = 0;
    }

    std::vector<Vec3f> run() {
        const std::size_t count = m_points.count, columns = m_points.columns;
        m_shared.resize(count);
        if (columns == 0) {
            for (std::size_t i = 0; i < count; ++i) {
                start(i);
                take(m_own, i - std::min(i, kRun), std::min(i + kRun + 1, count));
                finish();
            }
            return std::move(m_shared);
        }
        for (std::size_t i = 0; i < count; ++i)
            if (corners_of(i).front() == i) share_at(i);
        for (std::size_t i = 0; i < count; ++i) {
            const std::array<std::size_t, 4> corners = corners_of(i);
            if (corners.front() == i) continue;
            if (std::ranges::all_of(corners, [&](std::size_t c) { return tells_between(c, i); }))
                m_shared[i] = 0.25f * (m_shared[corners[0]] + m_shared[corners[1]] +
                                       m_shared[corners[2]] + m_shared[corners[3]]);
            else
                share_at(i);
        }
        return std::move(m_shared);
    }

  private:
    /// Of every second point of every second row and of the last ones, those around a point; all of
    /// them itself where it is such a one.
    std::array<std::size_t, 4> corners_of(std::size_t i) const {
        const std::size_t columns = m_points.columns, rows = m_points.count / columns;
        const auto around = [](std::size_t at, std::size_t last) {
            return at % 2 == 0 || at == last ? std::pair(at, at) : std::pair(at - 1, at + 1);
        };
        const auto [left, right] = around(i % columns, columns - 1);
        const auto [top, bottom] = around(i / columns, rows - 1);
        return {top * columns + left, top * columns + right, bottom * columns + left,
                bottom * columns + right};
    }
    /// Whether what varies slowly at a corner goes on to a point beside it.
    bool tells_between(std::size_t corner, std::size_t i) const {
        const float most = std::max(
            {m_own.by_reach[0][corner], m_own.by_reach[1][corner], m_own.by_reach[2][corner]});
        const float bend = 1.0f - glm::dot(m_points.normal[corner], m_points.normal[i]);
        return most * kSlowly * width_of(m_points, corner) < 1.0f && bend < kBendBetween &&
               m_own.side[corner] == m_own.side[i];
    }
    void share_at(std::size_t i) {
        start(i);
        const std::size_t columns = m_points.columns;
        const auto [top, bottom] = window(i / columns, m_points.count / columns);
        const auto [left, right] = window(i % columns, columns);
        for (std::size_t v = top; v < bottom; ++v)
            take(m_own, v * columns + left, v * columns + right);
        finish();
    }
    /// As many on each line of a lattice: at its end those of the one side, unless other grids go
    /// on there.
    std::pair<std::size_t, std::size_t> window(std::size_t at, std::size_t count) const {
        const std::size_t before = at - std::min(at, kNeighbourReach);
        if (!m_beside.empty()) return {before, std::min(at + kNeighbourReach + 1, count)};
        const std::size_t size = std::min(2 * kNeighbourReach + 1, count);
        const std::size_t first = std::min(before, count - size);
        return {first, first + size};
    }
    static V dot(const std::array<V, 3>& a, const Vec3f& b) {
        return a[0] * set(b.x) + a[1] * set(b.y) + a[2] * set(b.z);
    }

    void start(std::size_t i) {
        m_at = i;
        m_spreads = {};
        m_heights = {};
        const Vec3f& normal = m_points.normal[i];
        const Vec3f other = std::abs(normal.x) < 0.7f ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0);
        m_x = glm::normalize(glm::cross(normal, other));
        m_y = glm::cross(normal, m_x);
    }

    /// With what grids around tell.
    void finish() {
        find_near();
        for (const auto& [points, run] : m_near) take(*points, run->begin, run->end);
        for (std::size_t c = 0; c < 3; ++c) {
            const float height = m_heights[c].fit(m_spreads[c * m_channels_apart]);
            m_shared[m_at][static_cast<int>(c)] =
                std::isfinite(height) ? height : m_own.values[c][m_at];
        }
    }

    /// What lies beside the point at hand, or of more than enough some all over it.
    void find_near() {
        const Vec3f& p = m_points.p[m_at];
        const float reach = m_own.reach[m_at];
        m_near.clear();
        std::size_t count = 0;
        for (const Beside& grid : m_beside) {
            if (!is_within(grid.box, p, reach)) continue;
            for (const Run& run : grid.runs) {
                if (!is_within(run.box, p, reach)) continue;
                m_near.emplace_back(grid.points, &run);
                count += run.end - run.begin;
            }
        }
        if (count <= kEnough) return;
        const std::size_t found = m_near.size(),
                          kept = std::max<std::size_t>(found * kEnough / count, 1);
        for (std::size_t i = 0; i < kept; ++i) m_near[i] = m_near[i * found / kept];
        m_near.resize(kept);
    }

    void take(const NoisyPoints& from, std::size_t first, std::size_t last) {
        const Vec3f& p = m_points.p[m_at];
        for (std::size_t j = first; j < last; j += hn::Lanes(kTag)) {
            std::array<V, 3> way = at(from.p, j);
            for (int c = 0; c < 3; ++c) way[c] -= set(p[c]);
            const V distance = hn::Sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
            const V x = dot(way, m_x), y = dot(way, m_y);
            const V bend = set(1.0f) - dot(at(from.normal, j), m_points.normal[m_at]);
            const V alike = hn::Max(set(1.0f) - bend / set(kBend), set(0.0f));
            const auto counts = hn::And(hn::FirstN(kTag, last - j),
                                        hn::Eq(at(from.side, j), set(m_own.side[m_at])));
            const V asked = hn::IfThenElseZero(counts, at(from.asked, j) * alike);
            std::array<V, 3> weights;
            for (std::size_t c = 0; c < 3; ++c) {
                if (c == 0 || m_channels_apart) {
                    // What lies in a narrow place tells nothing of what is outside.
                    const V by_reach =
                        hn::Min(hn::Max(set(m_own.by_reach[c][m_at]), at(from.by_reach[c], j)),
                                set(m_own.most_by_reach[m_at]));
                    const V near = hn::Max(set(1.0f) - distance * by_reach, set(0.0f));
                    weights[c] = asked * near * at(from.told[c], j);
                    m_spreads[c].add(weights[c], x, y);
                } else {
                    weights[c] = weights[0];
                }
                m_heights[c].add(weights[c], x, y, at(from.values[c], j));
            }
        }
    }

    const ShadingPoints& m_points;
    const NoisyPoints& m_own;
    std::vector<Beside> m_beside;
    std::vector<std::pair<const NoisyPoints*, const Run*>> m_near;
    std::vector<Vec3f> m_shared;
    std::size_t m_channels_apart = 1;  ///< 0: all have the same neighbours
    std::size_t m_at = 0;
    Vec3f m_x{0.0f}, m_y{0.0f};
    std::array<Spread, 3> m_spreads;
    std::array<Heights, 3> m_heights;
};

}  // namespace

NoisyPoints::NoisyPoints(const ShadingPoints& points, const NoisyValues& noisy, float least_reach)
    : count(points.count),
      p(columns_of(points.p)),
      normal(columns_of(points.normal)),
      values(columns_of(noisy.values)),
      by_reach(columns_of(noisy.by_reach)),
      told(columns_of(noisy.told)) {
    for (const Vec3f& point : points.p) box.add(point);
    for (std::size_t i = 0; i < count; ++i) {
        const float seen = points.seen.empty() || points.seen[i] ? 1.0f : kHidden;
        const float share = points.shares.empty() ? 1.0f : points.shares[i];
        const float count = noisy.counts.empty() ? 1.0f : noisy.counts[i];
        side.push_back(points.backfacing.empty() ? 0.0f : points.backfacing[i]);
        asked.push_back(is_finite(noisy.values[i]) ? seen * share * count : 0.0f);
        const float step = std::max(width_of(points, i), 1e-30f);
        most_by_reach.push_back(1.0f / (least_reach * step));
        const float least = std::min({by_reach[0][i], by_reach[1][i], by_reach[2][i]});
        reach.push_back(std::min(static_cast<float>(kNeighbourReach) * step,
                                 1.0f / std::min(least, most_by_reach[i])));
        longest_reach = std::max(longest_reach, reach[i]);
    }
    const auto grey = [](const Vec3f& v) { return v.x == v.y && v.x == v.z; };
    is_grey = std::ranges::all_of(noisy.by_reach, grey) && std::ranges::all_of(noisy.told, grey);
    pad();
}

void NoisyPoints::pad() {
    const std::size_t room = count + hn::Lanes(kTag) - 1;
    for (Columns* columns : {&p, &normal, &values, &by_reach, &told})
        for (Column& column : *columns) column.resize(room);
    asked.resize(room);
    side.resize(room);
}

std::vector<Vec3f> NoisyPoints::all_values() const {
    std::vector<Vec3f> all(count);
    for (std::size_t i = 0; i < count; ++i) all[i] = {values[0][i], values[1][i], values[2][i]};
    return all;
}

std::size_t NoisyPoints::bytes() const {
    return 19 * asked.capacity() * sizeof(float);
}

std::vector<Vec3f> share(const ShadingPoints& points, const NoisyPoints& own,
                         std::span<const NoisyPoints* const> around) {
    return Sharing(points, own, around).run();
}

}  // namespace granita
