// SPDX-License-Identifier: GPL-3.0-or-later
// The scene as shadow rays see it: view-independent shapes, one Embree scene a geometry,
// instanced, in shading space (world axes, origin at the camera of the frame time; decision 12).
// What moves in the world has its motion knots in Embree; the camera's motion moves nothing.
#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include "base/progress.h"
#include "dice/grid.h"
#include "scene/scene.h"
#include "shade/shadow_opacity.h"

namespace granita {

/// Where a ray from a grid's point `p` must start so as to clear the grid's own triangles: lifted
/// along the geometric normal by the rounding of positions and by the largest distance between the
/// surface and its triangles.
struct RayLift {
    float distance = 0.0f;  ///< of the object's origin from that of shading space, metres
    float extent = 0.0f;    ///< largest coordinate of the face in its object, metres
    float error = 0.0f;     ///< between surface and triangles, metres
    bool casts = false;     ///< false: rays meet no triangles of it

    /// Positions are rounded to float in shading space and again in object space, each to 2^-24 of
    /// the largest coordinate on the way; 2^-20 leaves room for a dozen such steps.
    static constexpr float kRounding = 0x1p-20f;

    Vec3f operator()(const Vec3f& p, const Vec3f& geometric_normal) const {
        float size = glm::length(p);  // of all numbers on the way, summed
        if (casts) {
            const float from_origin = size + distance;  // of p, at most
            size = from_origin + std::max(from_origin, extent);
        }
        return p + geometric_normal * (kRounding * size + error);
    }
};

/// A way of light, in shading space.  What is no number, or 1e18 metres away, meets nothing.
struct ShadowRay {
    Vec3f start, direction;  ///< direction is unit
    float distance;          ///< metres; may be infinite
    float time = 0.5f;       ///< of the shutter, [0, 1]
};

class RayScene {
  public:
    /// `origin`: the camera's world position.  Only instances that cast shadows are in it.  Throws
    /// Cancelled, or SceneError naming the geometry that Embree could not take.
    RayScene(const Scene& scene, const Vec3d& origin, ShadowOpacity opacity,
             const Progress& progress);
    ~RayScene();

    bool empty() const;
    /// Whether any caster moves or deforms within the shutter.
    bool moves() const;
    /// Whether what passes along the segment may depend on time: false where no caster's way comes
    /// near it.
    bool varies(const Vec3f& start, const Vec3f& direction, float distance) const;
    std::size_t bytes() const;

    /// Of the points of a grid, or of those that lie on one face of several (ShadingPlaces::faces).
    RayLift lift(const GridKey& key) const;

    /// Share of light that passes, per channel.
    Vec3f transmittance(const ShadowRay& ray) const;
    /// The same of many, bit by bit; fastest where neighbours in the list go the same way.
    void transmittances(std::span<const ShadowRay> rays, std::span<Vec3f> left) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace granita
