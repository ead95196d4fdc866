// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_set.h"

#include <algorithm>
#include <limits>

namespace granita {
namespace {

/// As many lamps are all asked: no choice pays.
constexpr std::size_t kFewLamps = 16;

}  // namespace

LampSet::LampSet(const Scene& scene, const Vec3d& origin) : shutter(scene.options.shutter_curve) {
    for (const Light& light : scene.lights) {
        float energy = std::abs(light.energy);
        for (const float knot : light.energy_knots) energy = std::max(energy, std::abs(knot));
        if (light.color * energy == Vec3f(0.0f) || light.lifespan.is_empty()) continue;
        lamps.emplace_back(light, scene.options.frame_time, origin);
        varies = varies || lamps.back().varies();
    }
    const auto without_place = [](const Lamp& lamp) {
        LightBound bound;
        return !lamp.bound(bound);
    };
    const auto placed = static_cast<std::size_t>(
        std::ranges::count_if(lamps, [&](const Lamp& lamp) { return !without_place(lamp); }));
    if (placed <= kFewLamps) return;
    std::stable_partition(lamps.begin(), lamps.end(), without_place);
    everywhere = lamps.size() - placed;
    std::vector<LightBound> bounds(placed);
    for (std::size_t l = 0; l < placed; ++l) lamps[everywhere + l].bound(bounds[l]);
    std::vector<std::uint32_t> order;
    tree = std::make_unique<LightTree>(bounds, order);
    std::vector<Lamp> ordered;
    ordered.reserve(lamps.size());
    for (std::size_t l = 0; l < everywhere; ++l) ordered.push_back(std::move(lamps[l]));
    for (const std::uint32_t l : order) ordered.push_back(std::move(lamps[everywhere + l]));
    lamps = std::move(ordered);
}

void LampSet::set_casters(std::unique_ptr<RayScene> casters) {
    rays = std::move(casters);
    casters_move = rays && rays->moves();
    varies = varies || casters_move;
}

LitPlace LampSet::place_at(const LitPoint& point, float uniform) const {
    LitPlace place = point.at_frame;
    if (!varies) return place;
    place.time = shutter.time(point.exposed.x + uniform * (point.exposed.y - point.exposed.x));
    if (!point.paths.moves()) return place;
    const PointPaths::Place on_path = point.paths.at(point.index, place.time);
    place.p = on_path.p;
    place.normal = on_path.normal;
    place.start = point.ray_offset(on_path.start, on_path.normal);
    return place;
}

int LampSet::samples_of(const LitPoint& point, const Lamp& lamp) const {
    Vec3f center;
    float radius;
    const bool still = !lamp.varies() && !point.paths.moves();
    if (still && lamp.at(0.0f).bound(center, radius) &&
        !point.bsdf.can_see(center - point.at_frame.p, radius))
        return 0;
    if (!lamp.is_hard()) return point.sample_count;
    if (!changes(lamp)) return 1;
    if (lamp.varies() || point.paths.moves()) return point.sample_count;
    const LitPlace& place = point.at_frame;
    LightSample sample;
    if (!lamp.at(place.time).sample(place.p, Vec2f(0.0f), sample)) return 0;
    return rays->varies(place.start, sample.direction, sample.distance) ? point.sample_count : 1;
}

Ray LampSet::ray(const LitPoint& point, const LitPlace& place, const Vec3f& direction,
                 float distance, int blocker_set) const {
    const float there = glm::dot(place.normal, direction);
    const float at_frame = glm::dot(point.at_frame.normal, direction);
    const bool below = point.bsdf.transmits() && at_frame < 0.0f;
    const bool turned_away = below ? there >= 0.0f : there <= 0.0f && at_frame > 0.0f;
    const LitPlace& from = turned_away ? point.at_frame : place;
    if (point.through_tube)
        return {from.start_around(point.bsdf.surface_normal(), direction), direction, distance,
                from.time, blocker_set};
    return {below ? from.start_below() : from.start, direction, distance, from.time, blocker_set};
}

Vec3f LampSet::shadow(LitGrid& grid, const LitPoint& point, const LitPlace& place, const Lamp& lamp,
                      const LightSample& sample) const {
    if (!rays || !lamp.casts_shadow()) return Vec3f(1.0f);
    ++grid.shadow_rays;
    return rays->transmittance(
        ray(point, place, sample.direction, sample.distance, lamp.blocker_set()));
}

Vec3f LampSet::occlusion(LitGrid& grid, const LitPoint& point, const LitPlace& place,
                         const Vec3f& direction) const {
    if (!rays) return Vec3f(1.0f);
    ++grid.occlusion_rays;
    return rays->transmittance(
        ray(point, place, direction, std::numeric_limits<float>::infinity()));
}

}  // namespace granita
