// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that shine, as lamps: each triangle that rays meet of them is one.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "scene/scene.h"
#include "shade/lights/light_lamp.h"
#include "shade/rays/ray_scene.h"

namespace granita {

class LampFaces {
  public:
    LampFaces() = default;
    /// Of materials that RayMaterials::emitted tells; where there are too many, the brightest.
    /// Others are met by chance, and named; so are strands and points where nothing bounces.
    /// Throws Cancelled.
    LampFaces(const Scene& scene, const RayScene& rays, const RayMaterials& materials,
              const LightPatterns& patterns, Report& report, const Progress& progress);

    bool empty() const { return m_instances.empty(); }
    /// Once.
    std::vector<Lamp> take_lamps() { return std::move(m_lamps); }
    /// Of a material that shines: whether it is one of them.
    bool hold(const RayHit& hit) const;
    /// Whether all faces of an instance that shine are among them.
    bool hold_all_of(std::size_t instance) const {
        return !empty() && m_instances[instance] == Holds::All;
    }

  private:
    class Collector;
    enum class Holds : std::uint8_t { None, Some, All };
    void leave_out(std::uint32_t instance, const RayTarget& target);

    std::vector<Lamp> m_lamps;
    std::vector<Holds> m_instances;  ///< [instances]; empty: none are
    /// Faces that are dark, or one too many, by Embree's numbers, of instances that have such.
    std::unordered_map<std::uint32_t, std::vector<std::vector<bool>>> m_left_out;
};

}  // namespace granita
