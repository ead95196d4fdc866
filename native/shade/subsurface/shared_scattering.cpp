// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/subsurface/shared_scattering.h"

#include <algorithm>

#include "shade/bounces/neighbours.h"
#include "shade/lights/leaving_rays.h"

namespace granita {
namespace {

/// How far neighbours share, of a lobe's radius.
constexpr float kShared = 1.0f;
constexpr float kLeastWeight = 1e-6f, kLeastLight = 1e-20f;
constexpr float kLeastWay = 1e-9f;  // metres
/// Of the weight of the brightest point around: less is dark.
constexpr float kDark = 0.25f;
/// Points before and after one that are looked at, of separate faces.
constexpr std::size_t kRun = 8;

/// Calls `visit` with each point at most two steps away that lies next to one: on a lattice, or
/// among separate faces, which lie in Morton order.
template <class Visit>
void visit_around(const ShadingPoints& points, std::size_t i, const Visit& visit) {
    const std::size_t columns = points.columns;
    const float two_steps = 2.0f * width_of(points, i);
    const auto visit_run = [&](std::size_t at, std::size_t reach, std::size_t begin,
                               std::size_t end) {
        for (std::size_t j = at - std::min(at - begin, reach); j < std::min(at + reach + 1, end);
             ++j)
            if (glm::distance(points.p[j], points.p[i]) <= two_steps) visit(j);
    };
    if (columns == 0) return visit_run(i, kRun, 0, points.count);
    const std::size_t y = i / columns, rows = points.count / columns;
    for (std::size_t v = y - std::min<std::size_t>(y, 1); v < std::min(y + 2, rows); ++v)
        visit_run(v * columns + i % columns, 1, v * columns, (v + 1) * columns);
}

/// 1 / metres within which a channel varies little, no farther than ways go; 0 where nothing of it
/// scatters.
float by_reach(const ShadingPoints& points, const SurfaceClosure& closure, const WaysGone& gone,
               std::size_t point, int channel) {
    float nearest = 0.0f;
    for (const SubsurfaceLobe& lobe : closure.subsurface)
        if (lobe.weight[point][channel] != 0.0f)
            nearest = std::max(nearest, 1.0f / (kShared * lobe.radius[point][channel]));
    // One point's ways may be few.
    float weight = 0.0f, along = 0.0f;
    visit_around(points, point, [&](std::size_t i) {
        weight += gone.weight[i][channel];
        along += gone.along[i][channel];
    });
    if (nearest > 0.0f && weight > 0.0f)
        nearest = std::max(nearest, weight / std::max(along, kLeastWay * weight));
    return nearest;
}

/// Light by weight.  A dark point knows next to nothing of it (a medium is as light as asked for to
/// .002, and nothing enters where nothing is sent back), but samples between it and a bright one
/// need it: it has that of those around it.
std::vector<Vec3f> by_weight(const ShadingPoints& points, const std::vector<Vec3f>& weight,
                             const std::vector<Vec3f>& light) {
    std::vector<Vec3f> ratio(points.count);
    for (std::size_t i = 0; i < points.count; ++i) {
        ratio[i] = light[i] / glm::max(weight[i], Vec3f(kLeastWeight));
        Vec3f light_around(0.0f), weight_around(0.0f), most(0.0f);
        visit_around(points, i, [&](std::size_t j) {
            light_around += light[j];
            weight_around += weight[j];
            most = glm::max(most, weight[j]);
        });
        for (int c = 0; c < 3; ++c)
            if (weight[i][c] < kDark * most[c]) ratio[i][c] = light_around[c] / weight_around[c];
    }
    return ratio;
}

}  // namespace

Vec3f subsurface_weight(const SurfaceClosure& closure, std::size_t point) {
    Vec3f sum(0.0f);
    for (const SubsurfaceLobe& lobe : closure.subsurface) sum += lobe.weight[point];
    return sum;
}

NoisyPoints tell_scattered(const ShadingPoints& points, const SurfaceClosure& closure,
                           const WaysGone& gone, const std::vector<Vec3f>& light) {
    const std::size_t count = points.count;
    std::vector<Vec3f> weight(count);
    for (std::size_t i = 0; i < count; ++i) weight[i] = subsurface_weight(closure, i);
    NoisyValues noisy{by_weight(points, weight, light), std::vector<Vec3f>(count), weight};
    for (std::size_t i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c) noisy.by_reach[i][c] = by_reach(points, closure, gone, i, c);
    return NoisyPoints(points, noisy, 0.0f);
}

void reflect_scattered(const std::vector<Vec3f>& direct, const std::vector<Vec3f>& bounced,
                       const SurfaceClosure& closure, ReflectionParts* parts,
                       std::vector<Vec3f>& radiance) {
    for (std::size_t i = 0; i < direct.size(); ++i) {
        const Vec3f weight = subsurface_weight(closure, i);
        const Vec3f of_lamps = direct[i] * weight;
        const Vec3f of_others = bounced.empty() ? Vec3f(0.0f) : bounced[i] * weight;
        radiance[i] += of_lamps + of_others;
        if (!parts) continue;
        parts->diffuse[i] += of_lamps;
        parts->diffuse_bounced[i] += of_others;
        parts->diffuse_color[i] += weight;
    }
}

std::vector<Vec3f> scattered_beyond_typical(const std::vector<Vec3f>& direct,
                                            const std::vector<Vec3f>& bounced,
                                            const SurfaceClosure& closure) {
    std::vector<Vec3f> light = direct;
    for (std::size_t i = 0; i < bounced.size(); ++i) light[i] += bounced[i];
    Vec3f sum(kLeastLight), squares(0.0f);
    for (const Vec3f& one : light) {
        if (!is_finite(one)) continue;
        sum += one;
        squares += one * one;
    }
    const Vec3f typical = squares / sum;
    for (std::size_t i = 0; i < light.size(); ++i)
        light[i] = (light[i] - typical) * subsurface_weight(closure, i);
    return light;
}

}  // namespace granita
