// SPDX-License-Identifier: GPL-3.0-or-later
// Light that surfaces send to each other: ways from the points of a grid over other surfaces,
// traced and shaded in batches, a bounce of all at a time.
//
//   BouncedLight bounces(scene, direct, hits, emission, volumes, scatter, ...);    // once a frame
//   light = bounces.gather(leaving, points);          // any thread, any grid
//
// Each surface that is met adds what it emits, unless it is a lamp, and what of lamps and the world
// it reflects; one of its lobes' samples, or the way through it, is followed further by a choice
// after their weights; what fills the way before it adds what it emits, or scatters light itself.
// Rays that meet nothing bring the world.  Ways end by Cycles' limits, or by Russian roulette (Arvo
// and Kirk 1990) where they meet something.
//
// What a way brings depends on itself alone: pictures are the same to the bit however points are
// put together.
#pragma once

#include <functional>
#include <vector>

#include "base/progress.h"
#include "base/statistics.h"
#include "scene/scene.h"
#include "shade/bounces/bounced_path.h"
#include "shade/bounces/gathered_light.h"
#include "shade/bounces/hit_points.h"
#include "shade/bounces/hit_shader.h"
#include "shade/lights/direct_light.h"
#include "shade/nodes/material_emission.h"
#include "shade/volumes/volumes.h"

namespace granita {

/// Of light that enters surfaces and leaves them elsewhere (SubsurfaceLight::scatter).
using HitScattering =
    std::function<void(const ShadingPoints& hits, const SurfaceClosure& closure, const GridKey& key,
                       std::vector<Vec3f>& radiance, std::vector<LobeRay>& leaving)>;

class BouncedLight {
  public:
    /// All must outlive it; `direct` has rays.  `volumes` nullptr: nothing is filled.  `scatter`
    /// empty: subsurface is drawn as diffuse.
    BouncedLight(const Scene& scene, const DirectLight& direct, const HitShader& hits,
                 const MaterialEmission& emission, const Volumes* volumes, HitScattering scatter,
                 Statistics& statistics, const Progress& progress);

    /// What comes along the rays that leave `points`.
    GatheredLight gather(const std::vector<LobeRay>& leaving, std::size_t points) const;
    /// The same of points where a medium scatters light (ScatterPoints).
    GatheredLight gather_scattered(const std::vector<LobeRay>& leaving, std::size_t points) const;

  private:
    class Wave;

    /// Whether what a surface emits is light that DirectLight knows.
    bool is_lamp(const RayHit& hit) const {
        return m_emission.is_lamp(hit.material) && m_direct.lamp_faces().hold(hit);
    }

    const Scene& m_scene;
    const DirectLight& m_direct;
    const HitShader& m_hits;
    const MaterialEmission& m_emission;
    const Volumes* m_volumes;
    HitScattering m_scatter;
    bool m_any_shines = false;  ///< of surfaces that are no lamps
    Statistics& m_statistics;
    const Progress& m_progress;
};

}  // namespace granita
