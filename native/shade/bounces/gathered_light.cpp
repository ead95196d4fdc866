// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/gathered_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shade/bsdf/sheen_table.h"
#include "shade/lights/leaving_rays.h"

namespace granita {
namespace {

/// How far neighbours share, of the harmonic mean distance of other surfaces.
constexpr float kNear = 0.25f;
/// In steps of the grid: what varies faster than this is not drawn any more.
constexpr float kLeastReach = 2.0f;
/// Least albedo by which light is told: of what a pure red surface gets only the red is known.
constexpr float kLeastAlbedo = 1e-4f;
/// Points of a lattice to each side, and of separate ones in their order, whose rays tell together
/// how near other surfaces are.
constexpr std::size_t kAround = 2, kAroundRun = 8;
/// Of lattices the same where it decides who gathers more often: points that found little would
/// take more than those beside that found much.
constexpr std::size_t kAroundMore = 4;

/// How many points a point shares with, at least, if asking more often can make up for it; at most
/// so many times more, and all of a grid together no more often than those that share well.
constexpr float kSharing = 24.0f;
constexpr float kTimesMore = 7.0f;

/// Weight of a point's diffuse lobes, and of sheen what it reflects along the view: what turns is
/// seen from elsewhere than where its light was gathered.
Vec3f diffuse_albedo(const ShadingPoints& points, const SurfaceClosure& closure,
                     std::size_t point) {
    Vec3f sum(0.0f);
    for (const Lobe& lobe : closure.lobes) {
        if (part_of(lobe.kind) != LightPart::Diffuse) continue;
        float along_view = 1.0f;
        if (lobe.kind == LobeKind::Sheen)
            along_view =
                sheen_fit(glm::dot(lobe.normal[point], points.view[point]), lobe.roughness[point])
                    .albedo;
        sum += along_view * lobe.weight[point];
    }
    return sum;
}

/// [points] mean of 1 / distance of what the rays of a point and of those around it meet.  Its own
/// alone would say how far it shares by what it has found: points whose few rays meet nothing are
/// bright, and would tell more neighbours than those whose rays are hidden.
std::vector<float> mean_nearness(const ShadingPoints& points, const GatheredLight& light,
                                 std::size_t around = kAround) {
    const std::size_t count = points.count, columns = points.columns ? points.columns : count;
    const std::size_t across = points.columns ? around : kAroundRun,
                      down = points.columns ? around : 0;
    const std::size_t rows = count / std::max<std::size_t>(columns, 1);
    std::vector<float> means(count, 0.0f);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t x = i % columns, y = i / columns;
        float sum = 0.0f, met = 0.0f;
        for (std::size_t v = y - std::min(y, down); v <= std::min(y + down, rows - 1); ++v)
            for (std::size_t u = x - std::min(x, across); u <= std::min(x + across, columns - 1);
                 ++u) {
                sum += light.nearness[v * columns + u];
                met += light.met[v * columns + u];
            }
        if (met > 0.0f) means[i] = sum / met;
    }
    return means;
}

/// `diffuse` by albedo.
NoisyPoints told_of(const ShadingPoints& points, const SurfaceClosure& closure,
                    const std::vector<Vec3f>& diffuse, const std::vector<float>& nearness,
                    const std::vector<float>& counts) {
    NoisyValues noisy{diffuse, std::vector<Vec3f>(points.count), std::vector<Vec3f>(points.count)};
    for (std::size_t i = 0; i < points.count; ++i) {
        const Vec3f albedo = diffuse_albedo(points, closure, i);
        noisy.told[i] = Vec3f(glm::greaterThan(albedo, Vec3f(kLeastAlbedo)));
        noisy.values[i] *= noisy.told[i] / glm::max(albedo, Vec3f(kLeastAlbedo));
        noisy.by_reach[i] = Vec3f(nearness[i] / kNear);
    }
    noisy.counts = counts;
    return NoisyPoints(points, noisy, kLeastReach);
}

}  // namespace

std::vector<std::uint8_t> times_more(const ShadingPoints& points, const GatheredLight& light) {
    const std::vector<float> nearness = mean_nearness(points, light, kAroundMore);
    std::vector<float> wanted(points.count, 0.0f);
    float sum = 0.0f, crowded = 0.0f, seen = 0.0f;
    for (std::size_t i = 0; i < points.count; ++i) {
        if (!points.seen.empty() && !points.seen[i]) continue;
        ++seen;
        if (nearness[i] == 0.0f) continue;
        const float steps =
            std::max(kNear / (nearness[i] * std::max(width_of(points, i), 1e-30f)), kLeastReach);
        wanted[i] = std::clamp(kSharing / (steps * steps) - 1.0f, 0.0f, kTimesMore);
        sum += wanted[i];
        crowded += wanted[i] / kTimesMore;
    }
    const float most = seen - crowded;
    const float part = sum > most ? most / sum : 1.0f;
    std::vector<std::uint8_t> times(points.count);
    for (std::size_t i = 0; i < points.count; ++i)
        times[i] = static_cast<std::uint8_t>(std::lround(part * wanted[i]));
    return times;
}

void add_gathered(GatheredLight& light, const GatheredLight& more,
                  std::span<const std::uint8_t> which) {
    light.counts.resize(light.diffuse.size(), 1.0f);
    if (!more.world.empty()) {
        light.world.resize(light.diffuse.size());
        light.world_balance.resize(light.diffuse.size(), Vec2f(0.0f));
    }
    for (std::size_t i = 0; i < light.diffuse.size(); ++i) {
        if (!which[i]) continue;
        const float part = 1.0f / ++light.counts[i];
        light.diffuse[i] += part * (more.diffuse[i] - light.diffuse[i]);
        if (!light.world.empty()) {
            const Vec3f world = more.world.empty() ? Vec3f(0.0f) : more.world[i].diffuse;
            light.world[i].diffuse += part * (world - light.world[i].diffuse);
        }
        light.nearness[i] += more.nearness[i];
        light.met[i] += more.met[i];
    }
}

ToldGathered tell_gathered(const ShadingPoints& points, const SurfaceClosure& closure,
                           bool takes_world, bool tells_world, GatheredLight& light) {
    const std::vector<float> nearness = mean_nearness(points, light);
    ToldGathered told;
    if (takes_world && !light.world.empty()) {
        std::vector<Vec3f> world;
        for (std::size_t i = 0; i < light.world.size(); ++i) {
            world.push_back(std::exchange(light.world[i].diffuse, Vec3f(0.0f)));
            light.diffuse[i] += world[i];
            light.world_balance[i].x = 0.0f;
        }
        if (tells_world) told.world = told_of(points, closure, world, nearness, light.counts);
    }
    told.all = told_of(points, closure, light.diffuse, nearness, light.counts);
    return told;
}

void reflect_world(const GatheredLight& light, ReflectionParts* parts, std::vector<float>* noise,
                   std::vector<Vec3f>& radiance) {
    for (std::size_t i = 0; i < light.world.size(); ++i) {
        const BsdfValue& world = light.world[i];
        radiance[i] += total(world);
        if (noise) (*noise)[i] += light.world_balance[i].x + light.world_balance[i].y;
        if (!parts) continue;
        parts->diffuse[i] += world.diffuse;
        parts->glossy[i] += world.glossy;
        parts->transmission[i] += world.transmission;
    }
}

void reflect_gathered(const ShadingPoints& points, const GatheredLight& light, const Grid& grid,
                      const SurfaceClosure& closure, ReflectionParts* parts,
                      std::vector<Vec3f>& radiance) {
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        const Vec3f albedo = diffuse_albedo(points, closure, i);
        const Vec3f diffuse = grid.found.gathered[i] * albedo;
        const Vec3f others = light.glossy[i] + light.mirrored[i];
        if (parts) {
            // Planes are fitted to either: what lies on top of them is not less than nothing.
            const Vec3f of_world = grid.found.gathered_world.empty()
                                       ? Vec3f(0.0f)
                                       : glm::min(grid.found.gathered_world[i] * albedo, diffuse);
            parts->diffuse[i] += of_world;
            parts->diffuse_bounced[i] = diffuse - of_world;
            parts->glossy_bounced[i] = others - light.transmitted[i];
            parts->transmission_bounced[i] = light.transmitted[i];
        }
        radiance[i] += diffuse + others;
    }
}

}  // namespace granita
