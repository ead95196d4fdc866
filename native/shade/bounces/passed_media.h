// SPDX-License-Identifier: GPL-3.0-or-later
// What fills the ways to the surfaces that rays meet: what of it emits, takes light away, or
// scatters it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shade/bounces/bounced_path.h"
#include "shade/rays/ray_scene.h"
#include "shade/volumes/media_filler.h"
#include "shade/volumes/scatter_sampler.h"
#include "shade/volumes/volumes.h"

namespace granita {

class PassedMedia {
  public:
    /// A place in a medium that a way is scattered at.
    struct Scattering {
        std::uint32_t path;
        ScatterPlace place;
        float u;  ///< in [0, 1)
    };

    /// `seed`: of the frame; all must outlive it.
    PassedMedia(const Volumes& volumes, const Bounces& limits, std::uint32_t seed)
        : m_volumes(volumes), m_limits(limits), m_seed(seed) {}

    /// Looks along rays, a path's each, which end at what is `met` from now on.
    void find(const std::vector<RayScene::Met>& met, std::vector<Ray>& rays);
    /// [paths] what shines on their ways.
    const std::vector<Vec3f>& emitted() const { return m_emitted; }
    /// Takes from the paths' weights what does not pass.  Of a surface that one meets and a place
    /// before it that scatters light, one is gone on with, by chance: where it is the place, the
    /// surface is taken from `met`.
    /// @param meets_nothing [paths] where the way goes on to nothing and brings something there,
    /// from now on.
    void pass(std::span<const Ray> rays, std::vector<BouncedPath>& paths,
              std::vector<RayScene::Met>& met, std::vector<std::uint8_t>& meets_nothing);
    /// Those of ways after as many surfaces together.
    const std::vector<Scattering>& scattering() const { return m_scattering; }
    /// Metres to the first that sends light.
    float first_light(std::size_t path) const { return granita::first_light(m_media.of(path)); }

  private:
    float scatter(const BouncedPath& path, const Ray& ray, std::uint32_t i, float passing);

    const Volumes& m_volumes;
    const Bounces& m_limits;
    std::uint32_t m_seed;
    RayMedia m_media;
    std::vector<Vec3f> m_emitted, m_transmittance;  ///< [paths]
    std::vector<Scattering> m_scattering;
};

}  // namespace granita
