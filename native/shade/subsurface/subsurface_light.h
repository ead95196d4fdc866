// SPDX-License-Identifier: GPL-3.0-or-later
// Light that leaves a surface where it did not enter it: ways from the points of a grid through the
// inside of their mesh, whose ends are lit together as one batch.
//
//   SubsurfaceLight below(scene, direct, bent, progress);    // once a frame
//   light = below.gather(points, closure, grid.key, paths, parts, bounces);
//   below.scatter(hits, closure, key, radiance, leaving);    // of what rays meet
//
// What is gathered of a point depends on it alone: pictures are the same to the bit however points
// are put together.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "scene/scene.h"
#include "scene/shutter_warp.h"
#include "shade/bounces/bounced_light.h"
#include "shade/bounces/neighbours.h"
#include "shade/lights/direct_light.h"
#include "shade/nodes/node_compiler.h"

namespace granita {

/// What points tell their neighbours: radiance by the weight of what scatters.
struct ScatteredLight {
    NoisyPoints direct;
    std::optional<NoisyPoints> bounced;  ///< of other surfaces; none: light is not followed so far
};

class SubsurfaceLight {
  public:
    /// The surface of a material, whose nodes bend the normals by which light enters; nullptr:
    /// they do not.
    using BentSurface = std::function<const CompiledSurface*(std::int32_t material)>;

    /// All must outlive it; `direct` has rays.
    SubsurfaceLight(const Scene& scene, const DirectLight& direct, BentSurface bent,
                    const Progress& progress);

    /// What closure.subsurface scatters of points that are there at the times that `paths` and the
    /// shutter tell.  `parts`, where given, gets what arrives of lamps.  `bounces` nullptr: what
    /// enters has come straight from lamps and the world.
    ScatteredLight gather(const ShadingPoints& points, const SurfaceClosure& closure,
                          const GridKey& key, const PointPaths& paths, ReflectionParts* parts,
                          const BouncedLight* bounces) const;

    /// The same of HitPoints, whose share is that of one way a point.  Adds to [points] `radiance`
    /// what comes straight, and to `leaving` the rays along which other surfaces' light comes.
    void scatter(const ShadingPoints& hits, const SurfaceClosure& closure, const GridKey& key,
                 std::vector<Vec3f>& radiance, std::vector<LobeRay>& leaving) const;

  private:
    class Batch;

    const Scene& m_scene;
    const DirectLight& m_direct;
    BentSurface m_bent;
    const Progress& m_progress;
    ShutterWarp m_shutter;
};

}  // namespace granita
