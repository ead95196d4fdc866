// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "scene/scene.h"
#include "scene/shutter_warp.h"
#include "shade/lights/light_lamp.h"
#include "shade/lights/light_tree.h"
#include "shade/lights/lit_grid.h"
#include "shade/lights/lit_point.h"
#include "shade/rays/ray_scene.h"

namespace granita {

/// The lamps of a frame, and what comes before them.
struct LampSet {
    explicit LampSet(const Options& options)
        : shutter(options.shutter_curve),
          frame_time(options.frame_time),
          light_samples(std::max(1, options.light_samples)),
          bounces(options.bounces.most) {}
    /// Once, before light is asked for: those of which points ask a choice are put in trees. Throws
    /// Cancelled.
    void set_lamps(std::vector<Lamp> made, const Progress& progress);
    /// Traces shadows from now on.
    void set_casters(std::unique_ptr<RayScene> casters);

    /// The point at a time of its life drawn by `uniform` in [0, 1) through the shutter; at the
    /// frame time where nothing that light depends on changes.
    LitPlace place_at(const LitPoint& point, float uniform) const;
    /// Whether a lamp or its shadow does within the shutter.
    bool changes(const Lamp& lamp) const {
        return lamp.varies() || (casters_move && lamp.casts_shadow());
    }
    /// Light samples of a point for ShadingPoints::share: those that lie closer share the light
    /// that a pixel's worth of them is due.  A half, a quarter and so on, whichever is nearest: the
    /// sequences are stratified in powers of two (docs/decisions/lighting.md).
    int sample_count(float share) const {
        const float halved = share < 1.0f ? std::exp2(std::round(std::log2(share))) : share;
        return std::max(1,
                        static_cast<int>(std::lround(halved * static_cast<float>(light_samples))));
    }
    /// None of a lamp below the horizon; one tells all about a lamp without size that nothing
    /// moving can come before.
    int samples_of(const LitPoint& point, const Lamp& lamp) const;
    /// Of a lobe's sample, which lies to a side of the face, or RayType::Shadow: to light, which
    /// may come from a side of the smooth surface alone.
    Ray ray(const LitPoint& point, const LitPlace& place, const Vec3f& direction, float distance,
            RayType type, int blocker_set = -1) const;
    static void bend(const LitPoint& point, const LitPlace& place, Ray& ray);
    /// Towards what a lamp sends; likewise.
    Ray ray_to(const LitPoint& point, const LitPlace& place, const Lamp& lamp,
               const LightSample& sample, RayType type) const;
    /// What of a lamp's light, met by a ray of a lobe's, passes what such rays meet.
    Vec3f passed(LitGrid& grid, const LitPoint& point, const LitPlace& place, const Lamp& lamp,
                 const LightSample& sample, RayType type) const;
    /// What of the world's light passes what comes before it, along a ray of a type.
    Vec3f occlusion(LitGrid& grid, const LitPoint& point, const LitPlace& place,
                    const Vec3f& direction, RayType type) const;

    /// Whether the point lies under the lamp's own surface, by roundings or the sagitta of coarse
    /// faces: what passes between it and where its rays start gives it nothing.  Not of tubes.
    static bool is_beneath(const Lamp& lamp, const LitPoint& point, const LitPlace& place,
                           const Vec3f& direction) {
        const bool below = point.is_through(direction);
        return !point.round &&
               lamp.separates(place.time, place.p, below ? place.start_below() : place.start);
    }
    /// Whether points do not ask all lamps of `few`.
    bool chooses_of_few(const LitGrid& grid) const { return few && grid.placed && grid.depth > 0; }
    /// Calls `met(index, lamp, sample)` for lamps that samples of the grid's lobes meet along a
    /// direction.
    template <class Met>
    void meet(const LitGrid& grid, const LitPoint& point, const LitPlace& place,
              const Vec3f& direction, const Met& met) const {
        const auto ask = [&](std::size_t index) {
            const Lamp& lamp = lamps[index];
            LightSample sample;
            if (lamp.lights(grid.receives) && lamp.meets_lobes(grid.depth) &&
                lamp.meets(place.time, place.p, direction, sample) &&
                !is_beneath(lamp, point, place, direction))
                met(index, lamp, sample);
        };
        for (std::size_t l = 0; l < everywhere; ++l) ask(l);
        if (!tree) return;
        tree->meet(place.p, direction, [&](std::uint32_t l) {
            const std::optional<TriangleLight::Corners>& face = still_faces[l];
            if (!face || TriangleLight::crossing(*face, place.p, direction) > 0.0f)
                ask(everywhere + l);
        });
    }

    ShutterWarp shutter;
    float frame_time;
    int light_samples;           ///< of a soft lamp, at a point
    int bounces;                 ///< of the scene
    std::vector<Lamp> lamps;     ///< which all ask, then those of `few`, then of `tree`
    std::size_t always = 0;      ///< where those end that all points ask
    std::size_t everywhere = 0;  ///< and those that what rays meet chooses among
    /// Nullptr where these are too few for a choice to pay.
    std::unique_ptr<LightTree> few, tree;
    /// [lamps of `tree`] the triangles among them that stand still: of dozens that a ray comes by
    /// it meets a few, and those are all that it reads.
    std::vector<std::optional<TriangleLight::Corners>> still_faces;
    float asked = 0.0f;              ///< of `tree`, for each light sample
    std::unique_ptr<RayScene> rays;  ///< nullptr where nothing can cast a shadow
    bool parallel_view = false;      ///< beams that the camera sees do not widen
    bool casters_move = false;
    bool varies = false;                    ///< casters or lamps do, or what they light moves
    int asked_by_all = Light::kAnyBounces;  ///< bounces after which every lamp is still asked
    float places = 0.0f;                    ///< lamps that are no surfaces
};

/// Those of a scene that shine.  `origin`: the camera's world position at the frame time.
std::vector<Lamp> lamps_of(const Scene& scene, const Vec3d& origin, const LightPatterns& patterns);

}  // namespace granita
