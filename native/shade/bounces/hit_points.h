// SPDX-License-Identifier: GPL-3.0-or-later
// Places that rays have met, as the shading points of one instance.
#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"
#include "shade/bounces/bounced_path.h"
#include "shade/programs/program.h"
#include "shade/programs/shading_camera.h"
#include "shade/rays/hit_attributes.h"
#include "shade/rays/ray_scene.h"

namespace granita {

/// A surface that a way has met.
struct MetPath {
    const BouncedPath* path;  ///< nullptr: nobody goes on from there
    const RayHit* hit;
    const RayFrame* frame;  ///< of what was met, at `time`
    float time;
    float width;              ///< of the beam there, metres
    float length;             ///< that light goes to where it was sent from, metres
    float seen;               ///< that it goes to the camera; 0: not known
    std::uint32_t place = 0;  ///< LobeRay::place
};

inline MetPath met_by(const BouncedPath& path, const RayHit& hit, const RayFrame& frame) {
    return {&path,
            &hit,
            &frame,
            path.next.ray.time,
            path.width + path.spread * hit.distance,
            path.length + hit.distance,
            path.seen + hit.distance,
            path.next.place};
}

class HitPoints {
  public:
    /// `progress`: asked while programs run over input(); may be absent.
    HitPoints(const Scene& scene, const RayScene& rays, const Progress* progress = nullptr)
        : m_scene(scene), m_rays(rays), m_camera(scene), m_progress(progress) {}

    /// `met`: of one instance and material, after `depth` surfaces.  Textures are filtered by the
    /// width of each beam (Christensen et al. 2003).
    void fill(std::span<const MetPath> met, const std::vector<AttributeRequest>& requests,
              std::uint32_t depth);

    ShadingPoints& points() { return m_points; }
    /// Of points() and their attributes; valid until fill().
    const ShadingInput& input() const { return m_input; }

  private:
    void resize(std::size_t n, const std::vector<AttributeRequest>& requests);
    void fill_mesh(std::size_t i, const MetPath& met, bool displaced,
                   const std::vector<AttributeRequest>& requests);
    bool fill_smooth(std::size_t i, const MetPath& met);
    void fill_ribbon(std::size_t i, const MetPath& met);

    const Scene& m_scene;
    const RayScene& m_rays;
    ShadingCamera m_camera;
    const Progress* m_progress;
    ShadingPoints m_points;
    HitAttributes m_attributes;
    ShadingInput m_input;
};

}  // namespace granita
