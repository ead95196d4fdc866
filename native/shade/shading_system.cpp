// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shading_system.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "shade/grid_shading.h"
#include "shade/left_to_samples.h"
#include "shade/lights/light_sample_count.h"
#include "shade/nodes/surface_run.h"
#include "shade/pattern_probes.h"
#include "shade/point_shader.h"
#include "shade/seen_points.h"
#include "shade/seen_triangles.h"
#include "shade/shading_points.h"
#include "shade/time_probes.h"

namespace granita {
namespace {

/// One point of as many that turns within the shutter leaves its grid to samples: along the
/// silhouettes of round things that move a few do.
constexpr std::size_t kTurned = 8;

}  // namespace

struct ShadingSystem::Impl : PointShader {
    using PointShader::PointShader;

    float sharpness(Grid& grid) const {
        if (grid.sharpness == 0.0f)
            grid.sharpness = light_sample_step(light_sample_count(grid, scene, shutter));
        return grid.sharpness;
    }
    float edge_share(const Grid& grid) const {
        return light_sample_step(edge_light_sample_count(grid, scene));
    }

    Grid refine(const Grid& grid, std::span<const RefinedPoint> wanted, float point_size) const {
        Grid out = refine_lit(grid, wanted, point_size);
        if (grid.found_alone) catchers->divide(out, grid, wanted, channels);
        return out;
    }

    Grid refine_lit(const Grid& from, std::span<const RefinedPoint> wanted,
                    float point_size) const {
        std::optional<SeenTriangles> seen;
        if (from.triangles) wanted = seen.emplace(from, wanted).points;
        const Grid& grid = seen ? seen->grid : from;
        RefinedPoints refined(grid, scene, camera, eye, wanted, moves, point_size);
        refined.points.round = kind_of(grid, scene) == GeometryKind::Curves;
        refined.points.narrow = refined.points.round && from.n_v == 1;
        // Small faces share what one bucket sees; ribbons' noise would fall by 3 %, bits differ.
        refined.points.alone = !grid.radiance.empty() || refined.points.round;
        if (light) light->lift(refined.points, grid.key);
        Grid out;
        out.key = grid.key;
        out.instance = grid.instance;
        out.material = grid.material;
        out.holdout = grid.holdout;
        out.n_u = static_cast<int>(wanted.size()) - 1;
        const Mat3f camera_from_world = glm::transpose(Mat3f(camera.world_from_camera));
        for (const Vec3f& p : refined.points.p) out.p.push_back(camera_from_world * p);
        out.found = refined.found;
        if (seen) out.opacity = std::move(seen->opacity);
        const ShadingInput in = input(grid, refined);
        if (!grid.opacity.empty()) shade_opacity(out, in);
        PointShading shading(material(grid.material).radiance, in);
        find_light(shading, out, {});
        shade(out, shading);
        return out;
    }

    /// @param painted what runs over them reads nothing of them.
    ShadingPoints points_of(const Grid& grid, bool painted) const {
        return painted ? painted_points(grid.point_count()) : shading_points(grid, camera);
    }
    RefinedPoints probed(const Grid& grid, std::span<const RefinedPoint> wanted,
                         bool painted) const {
        return painted ? RefinedPoints(grid, wanted)
                       : RefinedPoints(grid, scene, camera, eye, wanted, moves, 1.0f);
    }

    /// Whether samples of the grid can be shaded by themselves.  Strands and spheres are drawn as
    /// something flat, whose places say little of their shadows.
    bool can_refine(const Grid& grid) const {
        return refines && !grid.shades_faces() && kind_of(grid, scene) == GeometryKind::Mesh;
    }

    /// Whether each sample may say what light it sees of the grid.
    bool may_leave(const Grid& grid) const {
        return refines && reflects(grid.material) && !grid.holdout;
    }

    /// Whether some of the grid's micropolygons look otherwise at some time of the shutter than
    /// when it opens: all else being equal, light samples too.
    bool changes_in_time(Grid& grid, const GridShading& begun) const {
        if (!moves || is_painted(grid.material) || (!light && are_equal(grid.radiance)))
            return false;
        if (changes_at(grid, TimeProbes(grid, scene.options.frame_time))) return true;
        // Of what stands still each sample is right at any time.
        return begun.at.moves() && !grid.shades_lattice() &&
               changes_at(grid, TimeProbes(grid, begun.doubts.sights));
    }
    bool changes_at(Grid& grid, const TimeProbes& probes) const {
        if (probes.points.empty()) return false;
        const Grid found = refine(grid, probes.points, 1.0f);
        grid.broken_radiance |= found.broken_radiance || found.broken_opacity;
        return probes.any_changes(found.radiance, thresholds.difference, displayed_difference);
    }

    /// Whether a lamp is mirrored for a part of the shutter: hardly ever at one of those times by
    /// one of few micropolygons.
    bool highlights_pass(Grid& grid) const {
        const TimeProbes probes(grid, scene.options.frame_time, TimeProbes::kOfLooks);
        const RefinedPoints found(grid, scene, camera, eye, probes.points, moves, 1.0f);
        const SurfaceRun ran(material(grid.material).radiance, input(grid, found));
        grid.broken_radiance |= ran.broken() > 0;
        return light->highlights_pass(ran.points(), ran.closure(), grid.key);
    }

    /// The same of its opacity: of what grazes the view, say.
    bool opacity_changes_in_time(Grid& grid) const {
        if (!moves || material(grid.material).opacity_program.is_still()) return false;
        const TimeProbes probes(grid, scene.options.frame_time);
        return probes.any_changes(opacity_at(grid, probes.points), thresholds.difference,
                                  opacity_difference);
    }

    std::vector<Vec3f> opacity_at(Grid& grid, std::span<const RefinedPoint> wanted) const {
        const RefinedPoints points =
            probed(grid, wanted, material(grid.material).opacity_program.is_still());
        Grid out;
        out.material = grid.material;
        shade_opacity(out, input(grid, points));
        grid.broken_opacity |= out.broken_opacity;
        return std::move(out.opacity);
    }

    /// Marks all of a grid whose corners do not tell what patterns show between them.  Blur is no
    /// help: lines that go where a thing moves stay lines.
    void find_patterns(Grid& grid, const std::vector<float>& looks) const {
        const bool tells_light = !grid.found.gathered.empty();
        if (looks.empty() || (!tells_light && are_all_marked(grid.unsettled))) return;
        const PatternProbes probes(grid, grid.unsettled);
        const RefinedPoints found(grid, scene, camera, eye, probes.points, moves, 1.0f);
        const SurfaceRun ran(material(grid.material).radiance, input(grid, found));
        grid.broken_radiance |= ran.broken() > 0;
        const std::vector<float> there = looks_of(ran.points(), ran.closure());
        if (probes.hide_light(grid, there)) {
            // Samples look for it, each for itself.
            grid.found.gathered.clear();
            grid.found.gathered_world.clear();
        }
        if (probes.miss_looks(grid, there, looks, light != nullptr, thresholds.difference))
            grid.unsettled = all_micropolygons(grid);
    }
    /// The same of what reflects nothing.
    void find_sent_patterns(Grid& grid) const {
        const SurfaceProgram& surface = material(grid.material).radiance;
        if (!surface.is_patterned || surface.sources.reflects() ||
            surface.sources.emission.is(Vec3f(0.0f)) || are_all_marked(grid.unsettled))
            return;
        const PatternProbes probes(grid, grid.unsettled);
        const RefinedPoints found = probed(grid, probes.points, surface.program.is_still());
        const SurfaceRun ran(surface, input(grid, found));
        grid.broken_radiance |= ran.broken() > 0;
        if (probes.miss(grid.radiance, ran.closure().emission, thresholds.difference,
                        displayed_difference))
            grid.unsettled = all_micropolygons(grid);
    }
    /// How probes see lamps, by one sample each or by as many as corners take.
    std::vector<LampSight> see(const Grid& grid, const PatternProbes& probes,
                               std::span<const LampSight> lamps, bool by_one) const {
        RefinedPoints found(grid, scene, camera, eye, probes.points, moves, 1.0f);
        if (by_one) found.points.share = 0.0f;
        light->lift(found.points, grid.key);
        return light->see(found.points, grid.key, lamps);
    }
    /// The same where they do not tell shadows, of what stands still: probes have no way in the
    /// shutter.  Lattices blur more than their shadows are wide.
    void find_thin_shadows(Grid& grid, std::span<const LampSight> sights, float threshold) const {
        if (sights.empty() || grid.shades_lattice() || are_all_marked(grid.unsettled)) return;
        const std::span<const std::uint8_t> marks(grid.unsettled);
        PatternProbes probes(grid, any_differs(sights) ? marks : marks.first(0));
        probes.keep_shadowed(grid, sights, threshold);
        if (probes.points.empty()) return;
        const PatternProbes missed(
            probes.missed_shadows(grid, see(grid, probes, sights, true), sights, threshold));
        if (missed.points.empty()) return;
        // One sample of a lamp may be that which its penumbra hides.
        if (!missed.missed_shadows(grid, see(grid, missed, sights, false), sights, threshold)
                 .empty())
            grid.unsettled = all_micropolygons(grid);
    }
    void find_open_patterns(Grid& grid) const {
        if (!material(grid.material).radiance.is_patterned ||
            are_all_marked(grid.unsettled_opacity))
            return;
        const PatternProbes probes(grid, grid.unsettled_opacity);
        if (probes.miss(grid.opacity, opacity_at(grid, probes.points), thresholds.difference,
                        opacity_difference))
            grid.unsettled_opacity = all_micropolygons(grid);
    }

    /// Takes from an equal grid of an earlier picture what was found with as many light samples:
    /// radiance, and what the grid tells, or that alone.  False where there is neither.
    bool take_earlier(Grid& grid, float share) const {
        const Grid* same = shaded ? shaded->find(grid) : nullptr;
        if (same == nullptr) return false;
        // What samples are shaded by themselves goes by the share itself.
        const auto is_enough = [&](float with) {
            return with > 0.0f &&
                   (refines ? with == share
                            : !light || light->sample_count(with) == light->sample_count(share));
        };
        if (same->told && is_enough(same->told_share)) {
            grid.told = same->told;
            grid.told_share = same->told_share;
        }
        if (!is_enough(same->light_fraction)) return grid.told != nullptr;
        take_shading(*same, grid);
        statistics.add(Counter::GridsShadedBefore);
        return true;
    }

    PointPaths paths_of(const Grid& grid, const ShadingPoints& points) const {
        return light && light->varies() ? PointPaths(grid, scene, points) : PointPaths();
    }

    /// look_at(); without bounces nothing that is shaded goes by Samples.
    std::vector<std::size_t> look(const Grid& grid, ShadingPoints& points, const PointPaths& at,
                                  float narrow) const {
        const float edge =
            bounces ? std::min(1.0f, edge_light_fraction(scene.options.samples) / narrow) : 1.0f;
        return look_at(points, at, grid.key, *light->rays(), scene, eye, moves ? &shutter : nullptr,
                       edge);
    }

    /// What the grid's points find by themselves; nullptr: it is left to samples.
    std::shared_ptr<GridShading> begin(Grid& grid, bool lit, float sharpness, float dense) const {
        auto begun = std::make_shared<GridShading>();
        begun->points = points_of(grid, is_painted(grid.material) && channels.empty());
        ShadingPoints& points = begun->points;
        begun->wants_refining = can_refine(grid);
        const float narrow = edge_share(grid);
        begun->sharpness = sharpness;
        begun->fewer = sharpness * narrow;
        points.share *= begun->fewer;
        points.round = kind_of(grid, scene) == GeometryKind::Curves;
        if (light && lit) light->lift(points, grid.key);
        if (lit) begun->at = paths_of(grid, points);
        const bool looks = lit && (bounces || (below && moves && scatters(grid.material)));
        if (looks) {
            const std::vector<std::size_t> turned = look(grid, points, begun->at, narrow);
            if (begun->wants_refining && !turned.empty()) {
                // Else their lobes would gather the light of the inside.
                show_other_side(points, turned);
                light->lift(points, grid.key);
                begun->at = paths_of(grid, points);
                begun->turns = kTurned * turned.size() > points.count;
            }
        }
        if (begun->wants_refining && may_leave(grid) && !grid.opacity_varies &&
            !scatters(grid.material) && pays_by_samples(grid, points, looks, scene, *light)) {
            leave_to_samples(grid, channels.vertex_width());
            return nullptr;
        }
        points.share *= dense;
        begun->fewer *= dense;
        if (begun->wants_refining) begun->doubts.noise.assign(points.count, 0.0f);
        // Of what nobody sees grids around are told nothing.
        if (points.seen.empty() || std::ranges::count(points.seen, 0) < std::ssize(points.seen))
            find(grid, *begun);
        return begun;
    }

    void find(const Grid& grid, GridShading& begun) const {
        begun.in.emplace(input(grid, begun.points));
        begun.found.emplace(material(grid.material).radiance, *begun.in);
        find_light(*begun.found, grid, begun.at, begun.wants_refining ? &begun.doubts : nullptr);
    }

    /// Whether its light is divided by that of the plate, where grids tell each other nothing.
    bool catches(const Grid& grid) const {
        return catchers && scene.catches_shadows(grid.instance, grid.material);
    }

    void end(Grid& grid, GridShading& begun, const ToldLights& around) const {
        Doubts& doubts = begun.doubts;
        if (!begun.found) find(grid, begun);
        shade(grid, *begun.found, around, begun.wants_refining ? &doubts : nullptr);
        statistics.add(Counter::GridsShaded);
        if (catches(grid)) {
            // What is left of light tells nothing of color.
            doubts.settled.clear();
            doubts.looks.clear();
            catchers->divide(grid, channels, doubts.noise, doubts.sights);
        }
        if (!begun.wants_refining) return;
        if (grid.holdout && !catches(grid)) {
            grid.unsettled = grid.unsettled_opacity;
            return;
        }
        const float difference = thresholds.difference / (begun.sharpness * begun.sharpness);
        if (begun.turns || material(grid.material).has_lines() || changes_in_time(grid, begun) ||
            (doubts.may_pass && highlights_pass(grid)))
            grid.unsettled = all_micropolygons(grid);
        else
            find_unsettled(grid, doubts.settled, doubts.noise, difference,
                           thresholds.noise / (begun.fewer * begun.fewer));
        mark(grid.unsettled, doubts.highlights);
        find_patterns(grid, doubts.looks);
        if (!catches(grid)) find_sent_patterns(grid);
        if (!begun.at.moves() && grid.lifespan.is_whole())
            find_thin_shadows(grid, doubts.sights, difference);
    }
};

ShadingSystem::ShadingSystem(const Scene& scene, Statistics& statistics, Report& report,
                             const Progress& progress, bool refines, const PersistentShading& kept)
    : m_impl(std::make_unique<Impl>(scene, statistics, report, progress, refines, kept)) {}

ShadingSystem::~ShadingSystem() = default;

const std::vector<std::vector<AttributeRequest>>& ShadingSystem::requests() const {
    return m_impl->requests;
}

float ShadingSystem::threshold() const {
    return m_impl->thresholds.difference;
}

const MaterialDisplacement* ShadingSystem::displacement() const {
    return m_impl->displacement.get();
}

bool ShadingSystem::shares_light() const {
    return m_impl->bounces || m_impl->below;
}

bool ShadingSystem::has_light() const {
    return m_impl->light != nullptr;
}

std::shared_ptr<GeometryCache> ShadingSystem::geometries() const {
    return m_impl->geometries;
}

bool ShadingSystem::opacity_varies(int material) const {
    return !m_impl->material(material).transparency.is(Vec3f(0.0f));
}

bool ShadingSystem::opacity_asks_rays(int material) const {
    return material >= 0 && opacity_varies(material) && asks_rays(m_impl->graph_of(material));
}

bool ShadingSystem::reaches_others(int material) const {
    return !m_impl->material(material).shadow.transparency.is(Vec3f(0.0f)) ||
           m_impl->emission->any(material) ||
           m_impl->material(material).radiance.bends_scattered() ||
           (m_impl->volumes && m_impl->volumes->fills(material));
}

void ShadingSystem::shade_opacity(Grid& grid) const {
    if (!opacity_varies(grid.material)) return;
    const CompiledSurface& surface = m_impl->material(grid.material);
    const ShadingPoints points = m_impl->points_of(grid, surface.opacity_program.is_still());
    m_impl->shade_opacity(grid, m_impl->input(grid, points));
    const bool refines = m_impl->can_refine(grid), has_lines = refines && surface.has_lines();
    const auto is_open = [](const Vec3f& opacity) { return opacity != Vec3f(1.0f); };
    grid.opacity_varies = has_lines || std::ranges::any_of(grid.opacity, is_open);
    grid.additive = surface.radiance.sources.additive;
    if (refines && (grid.opacity_varies || surface.radiance.is_patterned)) {
        const float sharpness = m_impl->sharpness(grid);
        const float threshold = m_impl->thresholds.difference / (sharpness * sharpness);
        grid.unsettled_opacity = has_lines || m_impl->opacity_changes_in_time(grid)
                                     ? all_micropolygons(grid)
                                     : unsettled_opacity(grid, threshold);
        m_impl->find_open_patterns(grid);
        grid.opacity_varies |= !grid.unsettled_opacity.empty();
    }
    m_impl->statistics.add(Counter::GridsOpacityShaded);
}

bool ShadingSystem::leaves_to_samples(const Grid& grid) const {
    // Small faces that are not solid stay with their corners.
    return grid.triangles && !(grid.disjoint && grid.opacity_varies) && m_impl->may_leave(grid);
}

std::shared_ptr<GridShading> ShadingSystem::begin_radiance(Grid& grid, bool anew) const {
    if (leaves_to_samples(grid)) {
        leave_to_samples(grid, m_impl->channels.vertex_width());
        return nullptr;
    }
    const bool lit = m_impl->reflects(grid.material);
    const float sharpness = lit || m_impl->can_refine(grid) ? m_impl->sharpness(grid) : 1.0f;
    const float dense = lit && m_impl->light ? dense_light_fraction(grid, m_impl->scene) : 1.0f;
    const float share = grid.point_share * sharpness * m_impl->edge_share(grid) * dense;
    if (!anew && m_impl->take_earlier(grid, share)) return nullptr;
    auto begun = m_impl->begin(grid, lit, sharpness, dense);
    if (!begun) {
        grid.light_fraction = share;  // all of it is left to samples
        return nullptr;
    }
    begun->light_fraction = share;
    const bool tells = begun->found && !begun->found->told->empty() && !m_impl->catches(grid);
    if (tells && !grid.told) {
        grid.told = begun->found->told;
        grid.told_share = share;
    }
    return begun;
}

void ShadingSystem::end_radiance(Grid& grid, GridShading& begun, const ToldLights& around) const {
    m_impl->end(grid, begun, around);
    grid.light_fraction = begun.light_fraction;
}

void ShadingSystem::shade_radiance(Grid& grid) const {
    if (const auto begun = begin_radiance(grid, true)) end_radiance(grid, *begun, {});
}

Grid ShadingSystem::refine(const Grid& grid, std::span<const RefinedPoint> wanted) const {
    m_impl->statistics.add(Counter::PointsRefined, wanted.size());
    return m_impl->refine(grid, wanted, m_impl->footprint);
}

void ShadingSystem::background(const BackgroundRays& rays, std::vector<Vec3f>& out) const {
    m_impl->world.background(rays, out);
}

TextureStore& ShadingSystem::textures() const {
    return m_impl->textures;
}

const SeenVolumes* ShadingSystem::volumes() const {
    return m_impl->seen_volumes.get();
}

bool ShadingSystem::background_is_patterned() const {
    return m_impl->world.is_patterned(RayType::Camera);
}

bool ShadingSystem::background_is_constant() const {
    return m_impl->world.is_constant(RayType::Camera);
}

}  // namespace granita
