// SPDX-License-Identifier: GPL-3.0-or-later
// Which faces of polygons rays meet, in the mesh's own space.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/shared_geometry.h"
#include "scene/scene.h"
#include "shade/rays/kept_rays.h"
#include "shade/rays/ray.h"

namespace granita {

/// Rays meet one mesh; thread-safe.
class MeshRays {
  public:
    /// @param shape as of MeshRayStore
    /// @param lets_through whether something behind a face may be seen through it; empty: of none.
    MeshRays(std::shared_ptr<const KeptRayShape> shape, const SharedGeometry& shared,
             std::function<bool(std::uint32_t face)> lets_through);

    /// Adds the patches along a ray up to the first that lets nothing through.  Close to an edge
    /// what lies beyond it is added too, so that who asks the patches themselves finds no crack
    /// between them.
    /// `work`: kept by the caller for its memory.
    struct Hit {
        const BasePatch* patch;
        Vec2d uv;
    };
    struct Work {
        std::vector<Hit> hits;
        std::vector<Ray> beside;
    };
    void meet(const Ray& ray, std::vector<std::uint32_t>& patches, Work& work) const;

  private:
    struct Passing;
    static void note_passing(const RTCFilterFunctionNArguments* arguments);
    void trace(const Ray& ray, std::vector<Hit>& hits) const;
    void add_beside(const Ray& ray, const Hit& hit, std::vector<Ray>& rays) const;

    std::shared_ptr<const KeptRayShape> m_shape;
    const SharedGeometry& m_shared;
    std::function<bool(std::uint32_t)> m_lets_through;
    float m_extent;  ///< largest coordinate: rays round by it
};

/// Meshes as rays meet them, built when first asked for; those of shadows and bounces are taken
/// where there are such.  Thread-safe.
class MeshRayStore {
  public:
    /// What is given must outlive this.
    MeshRayStore(const Scene& scene, std::shared_ptr<KeptRays> kept, const Progress& progress);
    /// @param goes_on whether rays pass what they meet.
    std::shared_ptr<const KeptRayShape> shape(std::size_t geometry,
                                              const std::shared_ptr<const SharedGeometry>& shared,
                                              bool goes_on);

  private:
    const Scene& m_scene;
    const Progress& m_progress;
    std::shared_ptr<KeptRays> m_kept;
    std::mutex m_mutex;
    struct Entry {
        SharedOnce once;
        std::shared_ptr<const KeptRayShape> shape;
    };
    std::map<std::pair<std::size_t, bool>, Entry> m_entries;  ///< by geometry and `goes_on`
};

}  // namespace granita
