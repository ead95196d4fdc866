// SPDX-License-Identifier: GPL-3.0-or-later
// What the camera sees of volumes: how much of the light of surfaces passes them, what they emit,
// and what of lamps, the world and other surfaces they scatter.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shade/rays/ray.h"

namespace granita {

class BouncedLight;
class DirectLight;
class RayMedia;
class Volumes;
struct Scene;

/// A ray of the camera.
struct ViewRay {
    Ray ray;              ///< without end
    std::uint32_t place;  ///< in the sample sequences of the frame
    std::uint32_t end;    ///< its depths end before this one
};

/// At a depth of a ray.
struct SeenMedium {
    Vec3f transmittance{1.0f};  ///< from there to the camera
    // Light that reaches the camera from between the depth before and this.
    Vec3f emitted{0.0f};
    Vec3f direct{0.0f};    ///< scattered, of what sends it there
    Vec3f indirect{0.0f};  ///< scattered, by way of surfaces and other places
};

class SeenVolumes {
  public:
    /// All must outlive it; `volumes` get their rays.  `bounces` nullptr: light is not followed so
    /// far.
    SeenVolumes(const Scene& scene, Volumes& volumes, const DirectLight& light,
                const BouncedLight* bounces);

    /// `depths`: increasing along each ray, metres, ray after ray, of which the last may be
    /// infinite; fills `out` [depths].  Any thread.
    void see(std::span<const ViewRay> rays, std::span<const float> depths,
             std::span<SeenMedium> out) const;

  private:
    void add_scattered(std::span<const ViewRay> rays, const std::vector<Ray>& ways,
                       const RayMedia& media, std::span<const float> depths,
                       std::span<SeenMedium> out) const;

    const Scene& m_scene;
    const Volumes& m_volumes;
    const DirectLight& m_light;
    const BouncedLight* m_bounces;
};

}  // namespace granita
