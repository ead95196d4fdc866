// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lit_points.h"

#include <utility>

#include "shade/bsdf/bsdf_albedo.h"
#include "shade/lights/grid_samples.h"
#include "shade/lights/lamp_samples.h"
#include "shade/lights/leaving_rays.h"

namespace granita {

LitSets lit_points(const LampSet& set, LitGrid& grid, const ShadingPoints& points,
                   const SurfaceClosure& closure, const GridKey& key, const PointPaths& paths,
                   bool is_dark) {
    RayOffset ray_offset = set.rays ? set.rays->ray_offset(key) : RayOffset{};
    const Vec2f life_exposed = set.shutter.exposed(paths.lifespan());
    const int sample_count = set.sample_count(points.share);
    const std::size_t choice = lobe_choice_dimension(closure.lobes.size(), set.everywhere);
    const GgxAlbedo& albedo = GgxAlbedo::shared();
    LitSets sets;
    std::vector<LitPoint>& all = sets[grid.receives];
    all.reserve(is_dark || !points.receives.empty() ? 0 : points.count);
    for (std::size_t i = 0; i < points.count; ++i) {
        if (!grid.wants(i)) continue;
        PointBsdf bsdf(closure, points, i, albedo);
        if (bsdf.lobe_count() == 0) continue;
        if (ReflectionParts* parts = grid.parts) {
            const BsdfValue color = bsdf.albedo();
            parts->diffuse_color[i] = color.diffuse;
            parts->glossy_color[i] = color.glossy;
            parts->transmission_color[i] = color.transmission;
        }
        if (is_dark) continue;
        const Vec3f& normal = points.geometric_normal[i];
        const Vec3f p = points.p[i] + inwards(points, i);
        const Vec3f offset = points.ray_offset.empty() ? Vec3f(0.0f) : points.ray_offset[i];
        if (set.rays && !points.faces.empty())
            ray_offset = set.rays->ray_offset({key.instance, points.faces[i]});
        const Vec3f start = ray_offset(p + offset, normal);
        const bool timed = !points.times.empty() && points.times[i] >= 0.0f;
        const float time = timed ? points.times[i] : set.frame_time;
        const LitPlace at_frame{time, p, normal, start};
        const Vec2f exposed = timed ? Vec2f(set.shutter.uniform(time)) : life_exposed;
        int count = sample_count;
        std::uint32_t place = place_in_sequence(points, i);
        if (!points.shares.empty() && points.shares[i] != 1.0f) {
            count = set.sample_count(points.share * points.shares[i]);
            // Behind what the others take of the sequences: all ends at beyond * sample_count, what
            // lies between before three times that.
            const int ahead = points.shares[i] > ShadingPoints::kUnseenShare ? 1 : 3;
            place += beyond(points) * static_cast<std::uint32_t>(ahead * sample_count / count + 1);
        }
        std::vector<LitPoint>& lit = points.receives.empty() ? all : sets[points.receives[i]];
        lit.push_back(
            {i,
             std::move(bsdf),
             paths,
             ray_offset,
             at_frame,
             count,
             place,
             exposed,
             points.visible_times.empty() ? std::span<const float>() : points.visible_times[i],
             points.rise.empty() ? nullptr : &points.rise[i],
             points.terminator_offset,
             width_of(points, i),
             points.round,
             {}});
        lit.back().share_samples(grid.placed ? std::optional(grid.sequence(choice, place)(0).x)
                                             : std::nullopt);
    }
    return sets;
}

}  // namespace granita
