// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/unsettled.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/displayed.h"
#include "math/luminance.h"

namespace granita {
namespace {

/// Second differences of values in doubt are less than this times their standard deviation, all but
/// surely: their own is sqrt(6) of it, and a micropolygon has eight.
constexpr float kSpread = 6.0f;

/// Refined samples have one light sample each, or a few; corners have Options::light_samples, and
/// those of their neighbours.  What moves is in doubt about its time, which only samples know.
bool refining_spares_noise(const Options& options, bool moves) {
    return moves || options.samples >= 3 * options.light_samples;
}

using Shown = Vec3f;  ///< displayed colour
Shown shown_color(const Vec3f& c) {
    return {displayed(c.x), displayed(c.y), displayed(c.z)};
}

float most(const Shown& difference) {
    const Shown size = glm::abs(difference);
    return largest(size);
}

/// From a point's neighbour before it along u or v, and to the one after it.
struct Steps {
    Shown before{0.0f}, after{0.0f};
    bool has_before = false, has_after = false;

    bool known() const { return has_before && has_after; }
    /// What interpolation does not follow: slopes are drawn as they are.
    float bend() const { return known() ? most(after - before) : 0.0f; }
};

/// Where what a micropolygon shows was shaded.
struct Corner {
    std::size_t vertex, point;
};

/// The corners by which a grid's micropolygons are judged.
class MicropolygonCorners {
  public:
    explicit MicropolygonCorners(const Grid& grid) : m_points(grid.point_count()) {
        const auto count = static_cast<std::size_t>(grid.micropolygon_count());
        m_corners.reserve(count);
        for (std::size_t m = 0; m < count; ++m)
            m_corners.push_back(corners_of(grid, static_cast<int>(m)));
    }

    /// [points] `show(value)` of [vertices] values.
    template <class Show>
    std::vector<Shown> shown(const std::vector<Vec3f>& values, const Show& show) const {
        std::vector<Shown> shown(m_points);
        for (const auto& of : m_corners)
            for (const Corner& c : of) shown[c.point] = show(values[c.vertex]);
        return shown;
    }

    /// 1 for the micropolygons that `unsettled(corners, bend)` and those that share a point with
    /// one; `bend`: the most that what is shown bends at a corner.
    template <class Unsettled>
    std::vector<std::uint8_t> marked(const std::vector<Shown>& shown,
                                     const Unsettled& unsettled) const {
        std::vector<Steps> along_u(m_points), along_v(m_points);
        for (const auto& [a, b, c, d] : m_corners) {
            add_step(shown, a.point, b.point, along_u);
            add_step(shown, d.point, c.point, along_u);
            add_step(shown, a.point, d.point, along_v);
            add_step(shown, b.point, c.point, along_v);
        }
        std::vector<std::uint8_t> touched(m_points, 0);
        bool any = false;
        for (const auto& of : m_corners) {
            float bend = 0.0f;
            bool bends_u = false, bends_v = false;
            for (const Corner& c : of) {
                bend = std::max({bend, along_u[c.point].bend(), along_v[c.point].bend()});
                bends_u |= along_u[c.point].known();
                bends_v |= along_v[c.point].known();
            }
            // Where a micropolygon is alone in a row, a slope cannot be told from an edge.
            if (!bends_u) bend = std::max(bend, step_along_u(shown, of));
            if (!bends_v) bend = std::max(bend, step_along_v(shown, of));
            if (!unsettled(of, bend)) continue;
            any = true;
            for (const Corner& c : of) touched[c.point] = 1;
        }
        std::vector<std::uint8_t> marked;
        if (!any) return marked;
        marked.reserve(m_corners.size());
        for (const auto& of : m_corners)
            marked.push_back(
                std::ranges::any_of(of, [&](const Corner& c) { return touched[c.point] != 0; }));
        return marked;
    }

  private:
    /// Its own corners, or those of the lattice's cell around it.
    static std::array<Corner, 4> corners_of(const Grid& grid, int micropolygon) {
        const ShadingPositions& at = grid.shading_positions;
        if (!grid.shades_lattice()) {
            const Grid::Corners c = grid.corners(micropolygon);
            const auto corner = [&](int v) {
                const auto vertex = static_cast<std::size_t>(v);
                return Corner{vertex, grid.point_at(vertex)};
            };
            return {corner(c.v0), corner(c.v1), corner(c.v2), corner(c.v3)};
        }
        const int cell_u = micropolygon % grid.n_u / at.step_u;
        const int cell_v = micropolygon / grid.n_u / at.step_v;
        const auto corner = [&](int u, int v) {
            return Corner{static_cast<std::size_t>(v * at.step_v * grid.up() + u * at.step_u),
                          static_cast<std::size_t>(v * (grid.n_u / at.step_u + 1) + u)};
        };
        return {corner(cell_u, cell_v), corner(cell_u + 1, cell_v), corner(cell_u + 1, cell_v + 1),
                corner(cell_u, cell_v + 1)};
    }

    static void add_step(const std::vector<Shown>& shown, std::size_t from, std::size_t to,
                         std::vector<Steps>& steps) {
        const Shown step = shown[to] - shown[from];
        steps[from].after = steps[to].before = step;
        steps[from].has_after = steps[to].has_before = true;
    }

    static float step_along_u(const std::vector<Shown>& shown, const std::array<Corner, 4>& c) {
        return std::max(most(shown[c[1].point] - shown[c[0].point]),
                        most(shown[c[2].point] - shown[c[3].point]));
    }

    static float step_along_v(const std::vector<Shown>& shown, const std::array<Corner, 4>& c) {
        return std::max(most(shown[c[3].point] - shown[c[0].point]),
                        most(shown[c[2].point] - shown[c[1].point]));
    }

    std::size_t m_points;
    std::vector<std::array<Corner, 4>> m_corners;
};

/// No less than what `show(value)` bends anywhere. `show`: of each component, growing with it.
template <class Show>
float most_bend(const std::vector<Vec3f>& values, const Show& show) {
    Vec3f least(HUGE_VALF), most_of(-HUGE_VALF);
    for (const Vec3f& v : values) {
        least = glm::min(least, v);
        most_of = glm::max(most_of, v);
    }
    return 2.0f * most(show(most_of) - show(least));
}

std::vector<std::uint8_t> unsettled_radiance(const Grid& grid, std::span<const float> noise,
                                             float threshold, float noise_threshold) {
    if (are_equal(grid.radiance)) return {};
    const bool noise_marks = noise_threshold < HUGE_VALF &&
                             std::ranges::any_of(noise, [](float n) { return n != 0.0f; });
    if (!noise_marks && most_bend(grid.radiance, shown_color) <= threshold) return {};
    const MicropolygonCorners corners(grid);
    const std::vector<Shown> shown = corners.shown(grid.radiance, shown_color);
    return corners.marked(shown, [&](const std::array<Corner, 4>& of, float bend) {
        float doubt = 0.0f, level = 0.0f;
        for (const Corner& c : of) {
            doubt += 0.25f * noise[c.point] * noise[c.point];
            level += 0.25f * luminance(grid.radiance[c.vertex]);
        }
        const float shown_doubt = displayed(level + std::sqrt(doubt)) - displayed(level);
        return bend > threshold + kSpread * shown_doubt || shown_doubt > noise_threshold;
    });
}

}  // namespace

bool are_equal(const std::vector<Vec3f>& values) {
    return std::ranges::all_of(values, [&](const Vec3f& v) { return v == values[0]; });
}

UnsettledThresholds::UnsettledThresholds(const Options& options, bool moves)
    : difference(options.shading_threshold * 8.0f / std::sqrt(static_cast<float>(options.samples))),
      noise(refining_spares_noise(options, moves) ? difference : HUGE_VALF) {}

float displayed_difference(const Vec3f& a, const Vec3f& b) {
    return most(shown_color(a) - shown_color(b));
}

float opacity_difference(const Vec3f& a, const Vec3f& b) {
    return most(a - b);
}

void find_unsettled(Grid& grid, std::vector<Vec3f>& settled, std::span<const float> noise,
                    float threshold, float noise_threshold) {
    if (!settled.empty()) settled.swap(grid.radiance);
    grid.unsettled = unsettled_radiance(grid, noise, threshold, noise_threshold);
    if (!settled.empty()) settled.swap(grid.radiance);
    mark(grid.unsettled, grid.unsettled_opacity);
}

void mark(std::vector<std::uint8_t>& marks, const std::vector<std::uint8_t>& more) {
    if (marks.empty()) marks = more;
    for (std::size_t m = 0; m < more.size(); ++m) marks[m] |= more[m];
}

std::vector<std::uint8_t> unsettled_opacity(const Grid& grid, float threshold) {
    const auto as_it_is = [](const Vec3f& opacity) { return opacity; };
    if (most_bend(grid.opacity, as_it_is) <= threshold) return {};
    const MicropolygonCorners corners(grid);
    const std::vector<Shown> shown = corners.shown(grid.opacity, as_it_is);
    return corners.marked(
        shown, [&](const std::array<Corner, 4>&, float bend) { return bend > threshold; });
}

std::vector<std::uint8_t> all_micropolygons(const Grid& grid) {
    return std::vector<std::uint8_t>(static_cast<std::size_t>(grid.micropolygon_count()), 1);
}

void leave_to_samples(Grid& grid, int channels) {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    grid.radiance.assign(count, Vec3f(0.0f));
    grid.channels.assign(count * static_cast<std::size_t>(channels), 0.0f);
    grid.unsettled = all_micropolygons(grid);
}

}  // namespace granita
