// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/unsettled.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/luminance.h"

namespace granita {
namespace {

float displayed(float radiance) {
    if (!(radiance > 0.0f)) return 0.0f;
    return radiance < 1.0f ? std::sqrt(radiance) : 1.0f + 0.5f * std::log(radiance);
}

/// Second differences of values in doubt are less than this times their standard deviation, all but
/// surely: their own is sqrt(6) of it, and a micropolygon has eight.
constexpr float kSpread = 6.0f;

using Shown = Vec3f;  ///< displayed colour
Shown shown_color(const Vec3f& c) {
    return {displayed(c.x), displayed(c.y), displayed(c.z)};
}

float most(const Shown& difference) {
    const Shown size = glm::abs(difference);
    return std::max({size.x, size.y, size.z});
}

/// From a point's neighbour before it along u or v, and to the one after it.
struct Steps {
    Shown before{0.0f}, after{0.0f};
    bool has_before = false, has_after = false;

    bool known() const { return has_before && has_after; }
    /// What interpolation does not follow: slopes are drawn as they are.
    float bend() const { return known() ? most(after - before) : 0.0f; }
};

void add_step(const std::vector<Shown>& shown, std::size_t from, std::size_t to,
              std::vector<Steps>& steps) {
    const Shown step = shown[to] - shown[from];
    steps[from].after = steps[to].before = step;
    steps[from].has_after = steps[to].has_before = true;
}

/// Where what a micropolygon shows was shaded.
struct Corner {
    std::size_t vertex, point;
};

/// Its own corners, or those of the lattice's cell around it.
std::array<Corner, 4> shaded_corners(const Grid& grid, int micropolygon) {
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

float step_along_u(const std::vector<Shown>& shown, const std::array<Corner, 4>& c) {
    return std::max(most(shown[c[1].point] - shown[c[0].point]),
                    most(shown[c[2].point] - shown[c[3].point]));
}

float step_along_v(const std::vector<Shown>& shown, const std::array<Corner, 4>& c) {
    return std::max(most(shown[c[3].point] - shown[c[0].point]),
                    most(shown[c[2].point] - shown[c[1].point]));
}

}  // namespace

float displayed_difference(const Vec3f& a, const Vec3f& b) {
    return most(shown_color(a) - shown_color(b));
}

std::vector<std::uint8_t> unsettled_micropolygons(const Grid& grid, std::span<const float> noise,
                                                  float threshold, float noise_threshold) {
    const bool even = std::ranges::all_of(
        grid.radiance, [&](const Vec3f& radiance) { return radiance == grid.radiance[0]; });
    if (even) return {};
    const auto count = static_cast<std::size_t>(grid.micropolygon_count());
    std::vector<std::array<Corner, 4>> corners;
    corners.reserve(count);
    std::vector<Shown> shown(grid.point_count());
    for (std::size_t m = 0; m < count; ++m) {
        corners.push_back(shaded_corners(grid, static_cast<int>(m)));
        for (const Corner& c : corners.back())
            shown[c.point] = shown_color(grid.radiance[c.vertex]);
    }
    std::vector<Steps> along_u(shown.size()), along_v(shown.size());
    for (const auto& [a, b, c, d] : corners) {
        add_step(shown, a.point, b.point, along_u);
        add_step(shown, d.point, c.point, along_u);
        add_step(shown, a.point, d.point, along_v);
        add_step(shown, b.point, c.point, along_v);
    }
    std::vector<std::uint8_t> touched(shown.size(), 0);
    bool any = false;
    for (const auto& of : corners) {
        float change = 0.0f, doubt = 0.0f, level = 0.0f;
        bool bends_u = false, bends_v = false;
        for (const Corner& c : of) {
            change = std::max({change, along_u[c.point].bend(), along_v[c.point].bend()});
            bends_u |= along_u[c.point].known();
            bends_v |= along_v[c.point].known();
            doubt += 0.25f * noise[c.point] * noise[c.point];
            level += 0.25f * luminance(grid.radiance[c.vertex]);
        }
        // Where a micropolygon is alone in a row, a slope cannot be told from an edge.
        if (!bends_u) change = std::max(change, step_along_u(shown, of));
        if (!bends_v) change = std::max(change, step_along_v(shown, of));
        const float shown_doubt = displayed(level + std::sqrt(doubt)) - displayed(level);
        if (change <= threshold + kSpread * shown_doubt && shown_doubt <= noise_threshold) continue;
        any = true;
        for (const Corner& c : of) touched[c.point] = 1;
    }
    if (!any) return {};
    std::vector<std::uint8_t> marked;
    marked.reserve(count);
    for (const auto& of : corners)
        marked.push_back(
            std::ranges::any_of(of, [&](const Corner& c) { return touched[c.point] != 0; }));
    return marked;
}

}  // namespace granita
