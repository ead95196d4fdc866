// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "shade/background_rays.h"
#include "shade/lights/environment.h"
#include "shade/nodes/node_compiler.h"

namespace granita {

/// The world's programs: one for each type of ray that its graph tells apart, and a black one for
/// those that do not see it.
class WorldShader {
  public:
    /// Scene and textures must outlive it.
    WorldShader(const Scene& scene, TextureStore& textures, Report& report);

    bool is_constant(RayType ray) const { return emission(ray).is_constant(); }
    bool is_patterned(RayType ray) const { return program(ray).is_patterned; }
    /// Radiance along `directions` [n] unit, world axes, each standing for `spread` radians; fills
    /// `out` [n].  Any thread.
    void radiance(const std::vector<Vec3f>& directions, float spread, RayType ray,
                  std::vector<Vec3f>& out) const {
        evaluate(directions, {}, spread, ray, out);
    }
    /// The same as the camera sees it.
    void background(const BackgroundRays& rays, std::vector<Vec3f>& out) const {
        evaluate(rays.directions, rays.rasters, rays.spread, RayType::Camera, out);
    }
    /// As a light; calls this.
    WorldEvaluator evaluator() const;

  private:
    void evaluate(const std::vector<Vec3f>& directions, std::span<const Vec2f> rasters,
                  float spread, RayType ray, std::vector<Vec3f>& out) const;
    const SurfaceProgram& program(RayType ray) const;
    const VectorSource& emission(RayType ray) const { return program(ray).sources.emission; }

    std::vector<SurfaceProgram> m_programs;
    std::array<std::size_t, kRayTypes> m_program_of{};  ///< [types of rays]
    bool m_reads_images = false;
    bool m_is_smooth = false;  ///< nothing of its graph is narrower than images are
};

}  // namespace granita
