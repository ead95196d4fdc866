// SPDX-License-Identifier: GPL-3.0-or-later
// Light that arrives straight from lamps and the world and leaves along the view: the lighting of
// a grid (docs/decisions/lighting.md).
//
//   DirectLight light(scene, world, statistics, report, progress);   // once a frame
//   radiance = light.reflect(points, closure, grid.key);             // any thread, any grid
//
// Soft lights and lobes are both sampled and combined by the balance heuristic over all samples of
// a point (Veach 1997, 9.2.2), so that mirrors see lamps and rough surfaces see small suns without
// fireflies.  `Options::light_samples` is the number of samples a soft light, a world image and all
// lobes together take at a point; hard lights take one.
//
// Where casters or lights move, samples are spread over the shutter and the point goes along.  A
// sample whose light the moved surface has turned away from, while at the frame time it has not, is
// traced at the frame time: or a spinning ball would shade its own lit side.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "base/statistics.h"
#include "dice/grid.h"
#include "geometry/displacement.h"
#include "geometry/geometry_cache.h"
#include "scene/scene.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/reflection.h"
#include "shade/lights/environment.h"
#include "shade/lights/lamp_faces.h"
#include "shade/lights/lamp_sight.h"
#include "shade/lights/light_anchor.h"
#include "shade/lights/light_motion.h"
#include "shade/lights/light_pattern.h"
#include "shade/lights/lobe_ray.h"
#include "shade/lights/part_rays.h"
#include "shade/rays/persistent_rays.h"
#include "shade/rays/ray_materials.h"
#include "shade/rays/ray_scene.h"

namespace granita {

class DirectLight {
  public:
    /// Bakes the world and, if any light or the world or a surface shines, builds the ray scene.
    /// `world` is kept and called from any thread; scene, statistics and progress must outlive
    /// this.  Without `materials` every surface casts a full shadow and none is a lamp.
    /// `geometries`: shared with dicing, if it is given; `rays`: where built geometries are looked
    /// for and left; `displacement`: of instances, if there is any; `patterns`: of lamps, and
    /// surfaces, with nodes; `nodes_ask_rays`: others ask rays() too.  Throws Cancelled.
    DirectLight(const Scene& scene, WorldEvaluator world, Statistics& statistics, Report& report,
                const Progress& progress, RayMaterials materials = {},
                std::shared_ptr<GeometryCache> geometries = nullptr,
                std::shared_ptr<PersistentRays> rays = nullptr,
                const Displacement* displacement = nullptr, const LightPatterns& patterns = {},
                bool nodes_ask_rays = false);
    ~DirectLight();

    /// Lifts where rays of points start above the triangles that rays meet of a displaced surface.
    void lift(ShadingPoints& points, const GridKey& key) const;

    /// Whether anything that sheds light or casts shadows changes within the shutter: then
    /// reflect() wants to know where the points are.
    bool varies() const;

    /// Radiance reflected by the closure's lobes towards the view, [points.count]: the mean over
    /// the shutter, as far as the points are there, of what arrives, on the surface as it is at the
    /// frame time.  Fills `parts` where given, and `noise` [points.count] with how
    /// far, either way, each point's luminance is in doubt.  `leaving`: gets the ways from which
    /// surfaces would light the points, which their lobes are sampled by.  `sights`: gets how they
    /// see small lamps, of few.
    std::vector<Vec3f> reflect(const ShadingPoints& points, const SurfaceClosure& closure,
                               const GridKey& seed, ReflectionParts* parts = nullptr,
                               const PointPaths& paths = {}, std::vector<float>* noise = nullptr,
                               LeavingRays* leaving = nullptr,
                               std::vector<LampSight>* sights = nullptr) const;
    /// How other points see those lamps: of what is opaque, by one sample each.
    std::vector<LampSight> see(const ShadingPoints& points, const GridKey& seed,
                               std::span<const LampSight> lamps) const;

    /// Of a grid of these points: highlights between its corners (mirrored_lamps.h).
    std::vector<std::uint8_t> highlights(const Grid& grid, const ShadingPoints& points,
                                         const SurfaceClosure& closure) const;
    /// The same within the shutter: whether any may come and go, and whether some do between points
    /// of a grid at several times each (lamps_pass()).
    bool highlights_may_pass(const SurfaceClosure& closure, const GridKey& key) const;
    bool highlights_pass(const ShadingPoints& points, const SurfaceClosure& closure,
                         const GridKey& key) const;

    /// Those that are among the light that reflect() knows, so that ways which meet them bring
    /// none.
    const LampFaces& lamp_faces() const;
    /// What WorldAhead asks of it: radiance along `directions`, as the parts of light see it.
    void world_radiance(const std::vector<Vec3f>& directions, const PartRays& types,
                        std::vector<BsdfValue>& out) const;
    /// Light samples of a point for ShadingPoints::share.
    int sample_count(float share) const;

    /// The strongest of what has a place and stands still.
    const std::vector<LightAnchor>& anchors() const;

    /// What is met by rays; nullptr where none are traced.
    const RayScene* rays() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace granita
