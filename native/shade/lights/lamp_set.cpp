// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_set.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace granita {
namespace {

/// As many lamps, and faces that shine, are all asked by what the eye sees: no choice pays.
constexpr std::ptrdiff_t kFewLamps = 16, kFewFaces = 4;
/// As many are asked by what rays meet, too (docs/decisions/lighting.md).
constexpr std::size_t kFewOfMet = 8;
/// Of others, for each light sample: lamps take some samples each time, faces one.
constexpr float kAsked = 4.0f, kAskedOfFaces = 2.0f;

/// Of a ray's way to a surface that shines, and of the numbers that places are told in: what lies
/// in the lamp's own plane casts no shadow on it.
constexpr float kRounding = 0x1p-20f;

bool has_place(const Lamp& lamp) {
    LightBound bound;
    return !lamp.is_surface() && lamp.bound(bound);
}

/// Of lamps [begin, end), which are put into its order.
std::unique_ptr<LightTree> make_tree(std::vector<Lamp>& lamps, std::size_t begin, std::size_t end,
                                     const Progress& progress) {
    progress.check();
    std::vector<LightBound> bounds(end - begin);
    for (std::size_t l = begin; l < end; ++l) lamps[l].bound(bounds[l - begin]);
    std::vector<std::uint32_t> order;
    auto tree = std::make_unique<LightTree>(bounds, order, &progress);
    std::vector<Lamp> ordered;
    ordered.reserve(order.size());
    for (const std::uint32_t l : order) ordered.push_back(std::move(lamps[begin + l]));
    std::ranges::move(ordered, lamps.begin() + static_cast<std::ptrdiff_t>(begin));
    return tree;
}

}  // namespace

std::vector<Lamp> lamps_of(const Scene& scene, const Vec3d& origin, const LightPatterns& patterns) {
    std::vector<Lamp> lamps;
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        const LampPattern pattern =
            patterns.of_lights.empty() ? LampPattern{} : patterns.of_lights[l];
        float energy = std::abs(light.energy);
        for (const float knot : light.energy_knots) energy = std::max(energy, std::abs(knot));
        if (light.color * energy == Vec3f(0.0f) || light.lifespan.is_empty()) continue;
        lamps.emplace_back(light, scene.options.frame_time, origin, pattern);
    }
    return lamps;
}

void LampSet::set_lamps(std::vector<Lamp> made, const Progress& progress) {
    lamps = std::move(made);
    for (const Lamp& lamp : lamps) {
        varies = varies || lamp.varies();
        asked_by_all = std::min(asked_by_all, lamp.most_bounces());
        places += lamp.is_surface() ? 0.0f : 1.0f;
    }
    const bool many_lamps = std::ranges::count_if(lamps, has_place) > kFewLamps;
    const bool many_faces = std::ranges::count_if(lamps, &Lamp::is_surface) > kFewFaces;
    const auto is_chosen = [&](const Lamp& lamp) {
        return lamp.is_surface() ? many_faces : many_lamps && has_place(lamp);
    };
    const auto in_tree = std::stable_partition(lamps.begin(), lamps.end(), std::not_fn(is_chosen));
    const auto in_few = std::stable_partition(lamps.begin(), in_tree, [&](const Lamp& lamp) {
        return !has_place(lamp) || lamp.most_bounces() <= bounces;
    });
    everywhere = static_cast<std::size_t>(in_tree - lamps.begin());
    always = static_cast<std::size_t>(in_few - lamps.begin());
    asked = many_lamps ? kAsked : kAskedOfFaces;
    if (everywhere < lamps.size()) tree = make_tree(lamps, everywhere, lamps.size(), progress);
    for (std::size_t l = everywhere; l < lamps.size(); ++l) {
        const TriangleLight::Corners* const corners = lamps[l].corners();
        still_faces.push_back(corners ? std::optional(*corners) : std::nullopt);
    }
    if (everywhere - always > kFewOfMet) few = make_tree(lamps, always, everywhere, progress);
}

void LampSet::set_casters(std::unique_ptr<RayScene> casters) {
    rays = std::move(casters);
    casters_move = rays && rays->moves();
    varies = varies || casters_move;
}

LitPlace LampSet::place_at(const LitPoint& point, float uniform) const {
    LitPlace place = point.at_frame;
    if (!varies) return place;
    place.time = point.time(shutter, uniform);
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
    if (still && lamp.bound(center, radius) &&
        !point.bsdf.can_see(center - point.at_frame.p, radius))
        return 0;
    if (!lamp.is_hard()) return point.sample_count;
    if (!still) return point.sample_count;
    if (!changes(lamp)) return 1;
    const LitPlace& place = point.at_frame;
    LightSample sample;
    if (!lamp.sample(place.time, place.p, Vec2f(0.0f), sample)) return 0;
    return rays->varies(place.start, sample.direction, sample.distance) ? point.sample_count : 1;
}

Ray LampSet::ray(const LitPoint& point, const LitPlace& place, const Vec3f& direction,
                 float distance, RayType type, int blocker_set) const {
    const float there = glm::dot(place.normal, direction);
    const float at_frame = glm::dot(point.at_frame.normal, direction);
    const bool transmits = point.bsdf.transmits();
    const bool turned_away =
        transmits && at_frame < 0.0f ? there >= 0.0f : there <= 0.0f && at_frame > 0.0f;
    const LitPlace& from = turned_away ? point.at_frame : place;
    const Vec3f& outward = point.bsdf.surface_normal();
    // Lobes go by the smooth surface: light of lamps that they let through comes from below, be it
    // above the face itself.  Their own samples lie to a side of the face (PointBsdf::sample).
    const Vec3f& up = type == RayType::Shadow ? outward : from.normal;
    const bool below = transmits && glm::dot(up, direction) < 0.0f;
    const Vec3f start = point.round
                            ? from.start_around(outward, direction, point.ray_offset.length(from.p))
                        : below ? from.start_below()
                                : from.start;
    return {start, direction, distance, from.time, blocker_set, type};
}

/// Where it would end at the faces, though normals are turned to the lamp: coarse triangles do not
/// shade each other, above which it starts.  Without such an offset one does not shade itself: a
/// ray through it starts behind it (Cycles).
void LampSet::bend(const LitPoint& point, const LitPlace& place, Ray& ray) {
    if (!point.rise || ray.type != RayType::Shadow) return;
    const float smooth = glm::dot(point.bsdf.surface_normal(), ray.direction);
    const float flat = glm::dot(place.normal, ray.direction), offset = point.terminator_offset;
    if (smooth <= 0.0f || std::min(smooth, flat) >= offset) return;
    if (offset == 0.0f) {
        ray.start = place.start_below();
        return;
    }
    const float rise = smooth < offset ? 2.0f - (flat + smooth) / offset : 1.0f - flat / offset;
    ray.start += std::clamp(rise, 0.0f, 1.0f) * *point.rise;
}

Ray LampSet::ray_to(const LitPoint& point, const LitPlace& place, const Lamp& lamp,
                    const LightSample& sample, RayType type) const {
    Ray to = ray(point, place, sample.direction, sample.distance, type, lamp.blocker_set());
    const Vec3f unbent = to.start;
    bend(point, place, to);
    const bool is_near = sample.distance < std::numeric_limits<float>::infinity();
    if (!lamp.is_surface() && (to.start == unbent || !is_near)) return to;
    // Where it starts beside the point, as of strands and above coarse faces, it would pass the
    // surface or fall short.
    const Vec3f target = place.p + sample.direction * sample.distance;
    const Vec3f way = target - to.start;
    const float length = glm::length(way);
    if (length > 0.0f) to.direction = way / length;
    to.distance = length;
    if (!lamp.is_surface()) return to;
    const Vec3f size = glm::max(glm::abs(to.start), glm::abs(target));
    to.distance = std::max(0.0f, length - kRounding * std::max({length, size.x, size.y, size.z}));
    to.target = lamp.target();
    return to;
}

Vec3f LampSet::passed(LitGrid& grid, const LitPoint& point, const LitPlace& place, const Lamp& lamp,
                      const LightSample& sample, RayType type) const {
    if (!rays) return Vec3f(1.0f);
    ++grid.shadow_rays;
    return rays->transmittance(ray_to(point, place, lamp, sample, type));
}

Vec3f LampSet::occlusion(LitGrid& grid, const LitPoint& point, const LitPlace& place,
                         const Vec3f& direction, RayType type) const {
    if (!rays) return Vec3f(1.0f);
    ++grid.occlusion_rays;
    Ray to = ray(point, place, direction, std::numeric_limits<float>::infinity(), type);
    bend(point, place, to);
    return rays->transmittance(to);
}

}  // namespace granita
