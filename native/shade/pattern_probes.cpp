// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/pattern_probes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "math/displayed.h"
#include "math/luminance.h"
#include "shade/lights/grid_samples.h"
#include "shade/unsettled.h"

namespace granita {
namespace {

/// Micropolygons for each one that is asked: lines of a third of one over a tenth of a grid are
/// missed by fewer than one of a hundred grids.
constexpr int kStep = 4;
/// Probes of each where corners have found something: lines of a fifth of a pixel are dashes that
/// lack 6 % with one, nothing with three, and samples there cost more than these.
constexpr int kTimes = 3;
/// What lets as much more or less through is another thing.
constexpr float kAnother = 0.5f;
/// Of points that tell of shadows, to be asked again.
constexpr std::size_t kEnough = 16;
/// The light of a grid's corners that reflect less is not known by what they send out.
constexpr float kTold = 0.02f;

// Roberts (2018), "The Unreasonable Effectiveness of Quasirandom Sequences": two dimensions.
constexpr double kPlastic[] = {0.7548776662466927, 0.5698402909980532};

/// A place in the unit square from corner 0 to corner 2 of a micropolygon.
RefinedPoint in_square(const Grid& grid, int micropolygon, float x, float y) {
    const Grid::Corners c = grid.corners(micropolygon);
    const GridTriangle triangle{static_cast<std::uint32_t>(micropolygon), y > x};
    RefinedPoint point{{}, {}, kAnyTime, triangle.micropolygon};
    const float weights[2][3] = {{1 - x, x - y, y}, {1 - y, x, y - x}};
    for (std::size_t k = 0; k < 3; ++k) {
        point.vertex[k] = static_cast<std::uint32_t>(c.of(triangle, k));
        point.weight[k] = weights[triangle.second][k];
    }
    return point;
}

Vec3f head_on(const Lobe& lobe, std::size_t i) {
    const bool by_f0 = lobe.fresnel == FresnelKind::Schlick ||
                       lobe.fresnel == FresnelKind::F82Tint ||
                       lobe.fresnel == FresnelKind::Dielectric;
    return by_f0 ? lobe.weight[i] * lobe.f0[i] : lobe.weight[i];
}

/// Whether what a lamp sends is let `through` at a point otherwise than at all corners around it,
/// by more than the threshold, displayed.
bool is_other_shadow(const Grid& grid, const RefinedPoint& at, float through,
                     const LampSight& corners, float threshold) {
    Vec3f change(0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t corner = grid.point_at(at.vertex[k]);
        const float more = through - corners.through[corner];
        if (corners.through[corner] < 0.0f || !(std::abs(more) > kAnother)) return false;
        change += at.weight[k] * more * corners.light[corner];
    }
    const Vec3f shown = between(grid.radiance, at);
    return displayed_difference(shown, shown + change) > threshold;
}

struct Look {
    Vec3f color{0.0f}, bent{0.0f}, diffuse{0.0f}, sent{0.0f};
    float gloss = 0.0f;

    Look() = default;
    explicit Look(const float* v)
        : color(v[0], v[1], v[2]),
          bent(v[3], v[4], v[5]),
          diffuse(v[6], v[7], v[8]),
          sent(v[9], v[10], v[11]),
          gloss(v[12]) {}

    void add(const Vec3f& weight, const Vec3f& normal, float roughness, bool is_diffuse) {
        color += weight;
        if (is_diffuse) diffuse += weight;
        bent += luminance(weight) * normal;
        gloss += luminance(weight) * roughness;
    }
};
static_assert(sizeof(Look) == kLookWidth * sizeof(float));

}  // namespace

std::vector<float> looks_of(const ShadingPoints& points, const SurfaceClosure& closure) {
    std::vector<float> looks(points.count * kLookWidth);
    for (std::size_t i = 0; i < points.count; ++i) {
        Look look;
        // As modelled: about a silhouette what faces the eye turns over, and no pattern.
        const float side = points.backfacing[i] ? -1.0f : 1.0f;
        for (const Lobe& lobe : closure.lobes)
            look.add(head_on(lobe, i), lobe.normal[i] * side, lobe.roughness[i],
                     part_of(lobe.kind) == LightPart::Diffuse);
        if (!closure.emission.empty()) look.sent = closure.emission[i];
        std::memcpy(&looks[i * kLookWidth], &look, sizeof(look));
    }
    return looks;
}

bool are_all_marked(std::span<const std::uint8_t> marks) {
    return !marks.empty() && std::ranges::find(marks, 0) == marks.end();
}

bool any_differs(std::span<const LampSight> of_grid) {
    return std::ranges::any_of(of_grid, [](const LampSight& sight) {
        float least = HUGE_VALF, most = -HUGE_VALF;
        for (const float through : sight.through) {
            if (through < 0.0f) continue;
            least = std::min(least, through);
            most = std::max(most, through);
        }
        return most - least > kAnother;
    });
}

PatternProbes::PatternProbes(const Grid& grid, std::span<const std::uint8_t> marks) {
    const int count = grid.micropolygon_count();
    const std::uint64_t seed = grid_seed(grid.key, 0);
    const auto part = [&](int k, double step, int bits) {
        const double start = static_cast<double>(seed >> bits & 0xffffu) / 0x10000;
        const double at = start + k * step;
        return static_cast<float>(at - std::floor(at));
    };
    const auto ask = [&](int m, int times) {
        for (; times > 0; --times) {
            const int k = static_cast<int>(points.size());
            points.push_back(
                in_square(grid, m, part(k, kPlastic[0], 16), part(k, kPlastic[1], 32)));
        }
    };
    if (marks.empty() || are_all_marked(marks)) {
        const int step = std::min(kStep, count);
        const int first = static_cast<int>(seed % static_cast<std::uint64_t>(step));
        for (int m = first; m < count; m += step) ask(m, 1);
    }
    for (std::size_t m = 0; m < marks.size(); ++m)
        if (!marks[m]) ask(static_cast<int>(m), kTimes);
}

bool PatternProbes::miss_looks(const Grid& grid, std::span<const float> looks,
                               std::span<const float> of_grid, bool is_lit, float threshold) const {
    const std::vector<float> of_corners = blended_at(grid, points, of_grid, kLookWidth);
    const auto told = [&](std::size_t i) { return Look(&of_corners[i * kLookWidth]); };
    const auto reflected = [&](std::size_t i) {
        return std::max(luminance(between(grid.radiance, points[i]) - told(i).sent), 0.0f);
    };
    float light = 0.0f, albedo = 0.0f;
    for (std::size_t i = 0; i < points.size(); ++i) {
        light += reflected(i);
        albedo += luminance(told(i).color);
    }
    const bool is_known = albedo > kTold * static_cast<float>(points.size());
    light = is_known ? light / albedo : is_lit ? 1.0f : 0.0f;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Look corners = told(i), is(&looks[i * kLookWidth]);
        const float color = luminance(corners.color);
        const float here = color > kTold ? reflected(i) / color : light;
        const float turned =
            glm::length(is.bent - corners.bent) + std::abs(is.gloss - corners.gloss);
        const Vec3f shown = between(grid.radiance, points[i]);
        const Vec3f more = here * (is.color - corners.color) + is.sent - corners.sent;
        // As bright, but metal instead of paint.
        const Vec3f moved = here * (is.diffuse - corners.diffuse);
        // What is no number is not what corners tell.
        if (!(displayed_difference(shown, shown + more) <= threshold &&
              displayed_difference(shown, shown + moved) <= threshold &&
              displayed_difference(shown, shown + Vec3f(here * turned)) <= threshold))
            return true;
    }
    return false;
}

void PatternProbes::keep_shadowed(const Grid& grid, std::span<const LampSight> of_grid,
                                  float threshold) {
    std::erase_if(points, [&](const RefinedPoint& at) {
        return std::ranges::none_of(of_grid, [&](const LampSight& corners) {
            return is_other_shadow(grid, at, 0.0f, corners, threshold) ||
                   is_other_shadow(grid, at, 1.0f, corners, threshold);
        });
    });
}

std::vector<RefinedPoint> PatternProbes::missed_shadows(const Grid& grid,
                                                        std::span<const LampSight> sights,
                                                        std::span<const LampSight> of_grid,
                                                        float threshold) const {
    std::vector<RefinedPoint> missed;
    for (std::size_t l = 0; l < sights.size(); ++l) {
        const LampSight& there = sights[l];
        for (std::size_t i = 0; i < there.through.size() && missed.size() < kEnough; ++i)
            if (there.through[i] >= 0.0f &&
                is_other_shadow(grid, points[i], there.through[i], of_grid[l], threshold))
                missed.push_back(points[i]);
    }
    return missed;
}

bool PatternProbes::hide_light(const Grid& grid, std::span<const float> looks) const {
    const GridLight& found = grid.found;
    if (found.gathered.empty()) return false;
    std::vector<float> untold;  // [points of the grid][3]
    for (std::size_t i = 0; i < found.gathered.size(); ++i)
        for (int c = 0; c < 3; ++c)
            untold.push_back(found.gathered[i][c] == 0.0f && (found.gathered_world.empty() ||
                                                              found.gathered_world[i][c] == 0.0f)
                                 ? 1.0f
                                 : 0.0f);
    const std::vector<float> around = blended_at(grid, points, untold, 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3f diffuse = Look(&looks[i * kLookWidth]).diffuse;
        for (int c = 0; c < 3; ++c)
            if (diffuse[c] > kTold && around[3 * i + static_cast<std::size_t>(c)] > 0.0f)
                return true;
    }
    return false;
}

}  // namespace granita
