// SPDX-License-Identifier: GPL-3.0-or-later
// The scene as shadow rays see it: view-independent shapes, one Embree scene a geometry,
// instanced, in shading space (world axes, origin at the camera of the frame time; decision 12).
// What moves in the world has its motion knots in Embree; the camera's motion moves nothing.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "base/progress.h"
#include "base/report.h"
#include "dice/grid.h"
#include "geometry/displacement.h"
#include "geometry/geometry_cache.h"
#include "scene/scene.h"
#include "shade/rays/persistent_rays.h"
#include "shade/rays/ray.h"
#include "shade/rays/ray_hit.h"
#include "shade/rays/ray_materials.h"
#include "shade/rays/ray_offset.h"
#include "shade/rays/ray_triangles.h"
#include "shade/rays/volume_span.h"

namespace granita {

class RayScene {
  public:
    /// `origin`: the camera's world position.  Only instances that cast shadows or scatter light
    /// are in it, or all where light is followed from surface to surface.
    /// `geometries`: shared with dicing, where given; `report`: what geometries are reported to;
    /// `kept`: where built geometries are looked for and left; `displacement`: of instances, where
    /// there is any, which must outlive this.
    /// Throws Cancelled, or SceneError naming the geometry that Embree could not take.
    RayScene(const Scene& scene, const Vec3d& origin, RayMaterials materials,
             const Progress& progress, std::shared_ptr<GeometryCache> geometries = nullptr,
             Report* report = nullptr, std::shared_ptr<PersistentRays> kept = nullptr,
             const Displacement* displacement = nullptr);
    ~RayScene();

    /// Whether rays meet nothing, and pass nothing.
    bool empty() const;
    /// Whether any caster moves or deforms within the shutter.
    bool moves() const;
    /// Whether what passes along the segment may depend on time: false where no caster's way comes
    /// near it.
    bool varies(const Vec3f& start, const Vec3f& direction, float distance) const;
    std::size_t bytes() const;

    /// Of points of an instance: `up` [n] unit, to the side from which they are seen.
    struct Covered {
        const std::vector<Vec3f>&p, &up;
        const std::vector<std::uint8_t>& from_behind;  ///< [n] `up` points inwards
        const std::vector<float>& times;               ///< [n], or empty; negative: the frame time
    };
    bool is_displaced(const GridKey& key) const;
    /// [n] how far above points of a displaced instance its triangles lie that cover them: what is
    /// diced finer than those are may lie below them.  0 where it does not.
    std::vector<float> heights_over(const GridKey& key, const Covered& points) const;

    /// Of the points of a grid, or of those that lie on one face of several
    /// (ShadingPositions::faces).
    RayOffset ray_offset(const GridKey& key) const;

    /// A surface that one of several rays meets.
    struct Met {
        std::uint32_t ray;              ///< its number
        RayHit hit;                     ///< its frame: of what stands still, else nullptr
        std::optional<RayFrame> moved;  ///< of what does not, at the ray's time

        const RayFrame& frame() const { return moved ? *moved : *hit.frame; }
    };
    /// The nearest surfaces that are there at the rays' times, in their order; those of other rays,
    /// which meet none, are left out.
    void nearest(std::span<const Ray> rays, std::vector<Met>& out) const;

    /// The places where rays end on their targets, meshes of instances that they meet: a hit for
    /// each ray.
    void ends(std::span<const Ray> rays, std::vector<Met>& out) const;

    /// Shading space from an instance's own at equal steps of the shutter, as rays know it; none
    /// of what they do not meet.
    std::vector<Mat4d> transforms(std::size_t instance) const;
    /// What rays meet of an instance that they meet, in its own space.
    void triangles(std::size_t instance,
                   const std::function<void(const RayTriangle&)>& visit) const;

    /// One mesh alone, at a time of the shutter: what light inside of it meets.
    struct Body {
        std::uint32_t instance = 0;  ///< in Scene::instances
        Mat4d object_from_shading{1.0};
        float time = 0.0f;
        const RayFrame* still = nullptr;  ///< as RayHit::frame
        std::optional<RayFrame> moved;    ///< as Met's
    };
    /// Whether light can be followed inside of what the grid is of.
    bool has_body(const GridKey& key) const;
    Body body(const GridKey& key, float time) const;
    /// False where the ray, whose time is the body's, meets nothing.
    bool nearest(const Body& body, const Ray& ray, Met& met) const;

    /// Where the ray is inside of instances whose material fills them there, one after the other.
    /// What it leaves before it has entered it starts in.  Rays of a type to which an instance is
    /// not visible, and of times at which it is not there, do not meet it.
    void volumes(const Ray& ray, std::vector<VolumeSpan>& out) const;

    /// Whether it meets anything that casts shadows, even if light passes that.
    bool blocks(const Ray& ray) const;
    /// Share of light that passes, per channel.
    Vec3f transmittance(const Ray& ray) const;
    /// The same of many, bit by bit; fastest where neighbours in the list go the same way.
    void transmittances(std::span<const Ray> rays, std::span<Vec3f> left) const;

  private:
    /// transmittance() and transmittances() without volumes.
    Vec3f past_surfaces(const Ray& ray) const;
    void past_surfaces(std::span<const Ray> rays, std::span<Vec3f> left) const;

    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace granita
