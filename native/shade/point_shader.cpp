// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/point_shader.h"

#include <algorithm>

#include "base/crash_report.h"
#include "math/sampling.h"
#include "shade/bounces/way_choice.h"
#include "shade/grid_channels.h"
#include "shade/interpolated_points.h"
#include "shade/pattern_probes.h"
#include "shade/subsurface/shared_scattering.h"

namespace granita {

void PointShader::find_light(PointShading& s, const Grid& grid, const PointPaths& at,
                             Doubts* doubts) const {
    const CrashScope scope("shades", scene.instances[grid.instance].name);
    const SurfaceProgram& surface = material(grid.material).radiance;
    const ShadingPoints& points = s.ran.points();
    if (!s.closure.subsurface.empty()) {
        const bool has_body = below && light->rays()->has_body(grid.key);
        draw_as_diffuse(s.closure, has_body);
    }
    // What is scattered is told by corners that are not black; there samples were darker still.
    if (doubts && surface.is_patterned && !surface.scatters() && surface.sources.reflects())
        doubts->looks = looks_of(points, s.closure);
    if (doubts && light && !grid.shades_lattice())
        doubts->highlights = light->highlights(grid, points, s.closure);
    if (doubts && light && grid.motion)
        doubts->may_pass = light->highlights_may_pass(s.closure, grid.key);
    ReflectionParts* asked = channels.empty() ? nullptr : &s.parts;
    s.radiance.assign(points.count, Vec3f(0.0f));
    LeavingRays leaving;
    leaving.diffuse = grid.found.gathered.empty();
    // Fast GI hides the world by what is near alone, be no bounce followed.
    const Bounces& limits = scene.options.bounces;
    leaving.takes_world =
        bounces && (limits.diffuse > 0 || limits.occluded_from > 0) && surface.looks_ahead();
    if (light)
        s.radiance = light->reflect(points, s.closure, grid.key, asked, at,
                                    doubts ? &doubts->noise : nullptr, bounces ? &leaving : nullptr,
                                    doubts ? &doubts->sights : nullptr);
    else if (asked)
        s.parts.resize(points.count);
    if (bounces && !s.closure.lobes.empty()) gather(s, leaving, grid, at);
    if (!s.closure.subsurface.empty() && grid.found.scattered.empty())
        s.told->scattered = below->gather(points, s.closure, grid.key, at, asked, bounces.get());
}

void PointShader::shade(Grid& grid, PointShading& s, const ToldLights& around,
                        Doubts* doubts) const {
    const CrashScope scope("shades", scene.instances[grid.instance].name);
    const SurfaceProgram& surface = material(grid.material).radiance;
    const ShadingPoints& points = s.ran.points();
    ReflectionParts* asked = channels.empty() ? nullptr : &s.parts;
    std::vector<Vec3f>& radiance = s.radiance;
    // What of it is noise at single points: what neighbours do not share.
    std::vector<Vec3f> doubtful;
    share_told(points, *s.told, around, grid.found);
    if (s.gathered) {
        reflect_world(*s.gathered, asked, doubts ? &doubts->noise : nullptr, radiance);
        reflect_gathered(points, *s.gathered, grid, s.closure, asked, radiance);
        doubtful = std::move(s.gathered->glossy);
    }
    if (!s.closure.subsurface.empty())
        reflect_scattered(grid.found.scattered, grid.found.scattered_bounced, s.closure, asked,
                          radiance);
    if (doubts && !grid.found.scattered.empty()) {
        // Samples take it from the grid and know no better.
        const std::vector<Vec3f> shared =
            scattered_beyond_typical(grid.found.scattered, grid.found.scattered_bounced, s.closure);
        doubtful.resize(points.count, Vec3f(0.0f));
        for (std::size_t i = 0; i < shared.size(); ++i) doubtful[i] += shared[i];
    }
    for (std::size_t i = 0; i < s.closure.emission.size(); ++i)
        radiance[i] += s.closure.emission[i];
    const std::size_t broken = s.ran.broken() + make_finite(radiance);
    grid.broken_radiance |= broken > 0;
    warn_of_broken(grid.material, broken);
    if (doubts && !doubtful.empty()) {
        doubts->settled = radiance;
        for (std::size_t i = 0; i < points.count; ++i) doubts->settled[i] -= doubtful[i];
        make_finite(doubts->settled);
        interpolate_points(grid, 1, doubts->settled);
    }
    interpolate_points(grid, 1, radiance);
    grid.radiance = std::move(radiance);
    if (asked)
        fill_channels(grid, channels, scene, camera,
                      {points, s.closure, s.parts, s.ran.run(), surface.passes});
    statistics.add(Counter::PointsShaded, points.count);
}

void PointShader::shade_opacity(Grid& grid, const ShadingInput& in) const {
    const CompiledSurface& surface = material(grid.material);
    Run run = surface.opacity_program.prepare(in, in.points->count);
    surface.opacity_program.execute(run);
    grid.opacity = values_of(run, surface.transparency);
    const std::size_t broken = make_finite(grid.opacity);
    grid.broken_opacity = broken > 0;
    warn_of_broken(grid.material, broken);
    for (Vec3f& opacity : grid.opacity)
        opacity = glm::clamp(Vec3f(1.0f) - opacity, Vec3f(0.0f), Vec3f(1.0f));
    interpolate_points(grid, 1, grid.opacity);
}

void PointShader::gather(PointShading& s, LeavingRays& leaving, const Grid& grid,
                         const PointPaths& at) const {
    const ShadingPoints& points = s.ran.points();
    const float due = points.share * static_cast<float>(scene.options.light_samples);
    if (!points.places.empty() && due < 1.0f) thin_out(leaving.rays, scene.options.seed);
    s.gathered = bounces->gather(leaving.rays, points.count);
    if (leaving.diffuse && points.places.empty() && !points.alone)
        gather_more(s, leaving, grid, at);
    if (leaving.diffuse)
        s.told->gathered =
            tell_gathered(points, s.closure, leaving.takes_world, !channels.empty(), *s.gathered);
}

void PointShader::gather_more(PointShading& s, LeavingRays& leaving, const Grid& grid,
                              const PointPaths& at) const {
    const ShadingPoints& points = s.ran.points();
    std::vector<std::uint8_t> times = times_more(points, *s.gathered);
    GridKey key = grid.key;
    while (std::ranges::any_of(times, [](int t) { return t > 0; })) {
        key.path = mix_bits(key.path + 1);
        leaving.rays.clear();
        leaving.only = times;
        light->reflect(points, s.closure, key, nullptr, at, nullptr, &leaving);
        add_gathered(*s.gathered, bounces->gather(leaving.rays, points.count), times);
        for (std::uint8_t& t : times) t -= t > 0;
    }
}

}  // namespace granita
