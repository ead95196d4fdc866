// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "shade/lights/light_source.h"
#include "shade/rays/ray.h"

namespace granita {

/// A sample of a lamp of which its nodes are asked.
struct PatternSample {
    const LightFrame* frame;  ///< of the lamp, at the sample's time; nullptr: it is a surface
    Vec3f p;                  ///< to where the light goes
    LightSample* sample;
    float time = 0.0f;
    RayTarget target = {};  ///< of a surface
    float width = 0.0f;     ///< over which textures of a surface are filtered, metres
};

/// What nodes of a lamp, or of a surface that is one, make of its light.
class LightPattern {
  public:
    virtual ~LightPattern() = default;
    /// Multiplies their radiance; that of surfaces, which it tells itself, it sets.
    virtual void color(std::span<const PatternSample> samples) const = 0;
};

/// Of a lamp.
struct LampPattern {
    std::shared_ptr<const LightPattern> pattern;  ///< shared by lamps; nullptr: there are no nodes
    /// Mean of the channels of what it multiplies by, where that is largest; an estimate.
    float largest = 1.0f;
};

class RayScene;

/// Of the nodes of a scene.
struct LightPatterns {
    std::vector<LampPattern> of_lights;  ///< [lights], or empty: none has nodes
    /// Of surfaces whose RayMaterials::emitted varies; the rays outlive what is made.
    std::function<std::shared_ptr<const LightPattern>(std::int32_t material, const RayScene& rays)>
        of_surface;
};

}  // namespace granita
