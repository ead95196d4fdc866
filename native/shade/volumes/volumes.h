// SPDX-License-Identifier: GPL-3.0-or-later
// What fills the things of a frame, and its world: their programs, and the media along rays.
//
//   Volumes volumes(scene, textures, report);                        // once a frame
//   volumes.set_rays(rays);                                          // once these are there
//   volumes.find(rays, media);                                       // any thread, any batch
//
// Where coefficients vary, a ray goes through their things by steps, each asked at one place, all
// steps of a batch of rays together.
#pragma once

#include <array>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "base/report.h"
#include "scene/scene.h"
#include "shade/nodes/node_compiler.h"
#include "shade/rays/ray_materials.h"
#include "shade/rays/ray_scene.h"
#include "shade/volumes/media_filler.h"

namespace granita {

class Volumes {
  public:
    /// Whether anything of a scene is filled.
    static bool any(const Scene& scene);

    /// Scene and textures must outlive it.
    Volumes(const Scene& scene, TextureStore& textures, Report& report);

    /// Of a material.
    RayMaterials::Inside inside(std::int32_t material) const;
    bool fills(std::int32_t material) const {
        return inside(material) != RayMaterials::Inside::Nothing;
    }
    /// Adds what rays ask of volumes; must outlive it.
    void tell(RayMaterials& materials) const;
    /// Whether anything sends light out of itself.
    bool shines() const { return m_shines; }
    /// Whether anything scatters light.
    bool scatters() const { return m_scatters; }
    /// Of phase functions: the two that Blender 3.4 knows, and what else is there.
    const std::set<PhaseKind>& phase_kinds() const { return m_phase_kinds; }

    /// Which must outlive it.
    void set_rays(const RayScene* rays) { m_rays = rays; }

    /// What rays pass through, up to their distances.
    void find(std::span<const Ray> rays, RayMedia& media) const;
    /// As RayMaterials::dim; rays of the camera ask for surfaces alone.
    void dim(std::span<const Ray> rays, std::span<Vec3f> left) const;

  private:
    /// One for each type of ray that the graph tells apart.
    struct Programs {
        std::array<std::shared_ptr<const VolumeProgram>, kRayTypes> of_ray;
    };
    void measure();
    Programs compile(const NodeGraph& graph, TextureStore& textures, Report& report,
                     const GraphOwner& owner);

    const Scene& m_scene;
    const RayScene* m_rays = nullptr;
    std::vector<Programs> m_materials;  ///< [materials] of those that fill things
    Programs m_world;
    FilledThings m_things;
    bool m_shines = false, m_scatters = false;
    std::set<PhaseKind> m_phase_kinds{PhaseKind::HenyeyGreenstein, PhaseKind::Rayleigh};
};

}  // namespace granita
