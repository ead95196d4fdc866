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
#include "geometry/coincident_patches.h"
#include "geometry/shared_geometry.h"
#include "scene/scene.h"
#include "shade/rays/persistent_rays.h"
#include "shade/rays/ray.h"

namespace granita {

/// A mesh as rays meet it.
struct MeetableMesh {
    std::shared_ptr<const PersistentRayShape> shape;
    std::shared_ptr<const CoincidentPatches> coincident;
};

/// By how much places on a mesh are rounded by who asks the patches that rays name.
struct Rounding {
    Mat3f to_measured{1.0f};  ///< from the mesh's own space to that of the distance
    float distance = 0.0f;
};

/// Rays meet one mesh; thread-safe.
class MeshRays {
  public:
    /// @param lets_through whether something behind a face may be seen through it; empty: of none.
    MeshRays(MeetableMesh mesh, const SharedGeometry& shared,
             std::function<bool(std::uint32_t face)> lets_through);

    struct Hit {
        std::uint32_t patch;
        BasePatch at;
        Vec2d uv;
    };
    /// Kept by the caller for its memory and its counts.
    struct Work {
        std::vector<Hit> hits;
        std::vector<Ray> beside;
        std::uint64_t met = 0;     ///< faces
        std::uint64_t unsure = 0;  ///< of these, so small that neighbours may have been missed
    };
    /// Adds the patches along a ray up to the first that lets nothing through, and what lies on
    /// them.  Within rounding of an edge or a corner what lies beyond it is added too, so that who
    /// asks the patches themselves finds no crack between them.
    void meet(const Ray& ray, const Rounding& rounding, std::vector<std::uint32_t>& patches,
              Work& work) const;

  private:
    struct Passing;
    static void note_passing(const RTCFilterFunctionNArguments* arguments);
    Hit located(const RTCHit& at) const;
    void trace(const Ray& ray, std::vector<Hit>& hits) const;
    void add_beside(const Ray& ray, const Hit& hit, const Rounding& rounding, Work& work) const;
    Vec3f point_at(std::size_t vertex, float time) const;

    MeetableMesh m_mesh;
    const SharedGeometry& m_shared;
    std::function<bool(std::uint32_t)> m_lets_through;
};

/// Meshes as rays meet them, built when first asked for; those of shadows and bounces are taken
/// where there are such.  Thread-safe.
class MeshRayStore {
  public:
    /// `scene` and `progress` must outlive this.
    MeshRayStore(const Scene& scene, std::shared_ptr<PersistentRays> kept,
                 const Progress& progress);
    /// @param goes_on whether rays pass what they meet.
    MeetableMesh mesh(std::size_t geometry, const std::shared_ptr<const SharedGeometry>& shared,
                      bool goes_on);
    /// Surfaces that a ray through its bounds meets, about.
    double layers(std::size_t geometry, const SharedGeometry& shared);
    /// Whether it was there before this was made.
    bool was_there(std::size_t geometry, bool goes_on) const {
        return m_was_there[goes_on][geometry];
    }

  private:
    RayKey key(std::size_t geometry, bool goes_on) const;
    std::shared_ptr<const PersistentRayShape> find(std::size_t geometry, bool goes_on) const;

    const Scene& m_scene;
    const Progress& m_progress;
    std::shared_ptr<PersistentRays> m_kept;
    std::vector<bool> m_was_there[2];
    std::mutex m_mutex;
    struct Entry {
        SharedOnce once;
        MeetableMesh mesh;
    };
    std::map<std::pair<std::size_t, bool>, Entry> m_entries;  ///< by geometry and `goes_on`
    std::map<std::size_t, double> m_layers;
};

}  // namespace granita
