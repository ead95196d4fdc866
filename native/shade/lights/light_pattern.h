// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "shade/lights/light_source.h"

namespace granita {

/// A sample of a lamp of which its nodes are asked.
struct PatternSample {
    const LightFrame* frame;  ///< of the lamp, at the sample's time
    Vec3f p;                  ///< to where the light goes
    LightSample* sample;
};

/// What a lamp's nodes make of its light.
class LightPattern {
  public:
    virtual ~LightPattern() = default;
    /// Multiplies their radiance.
    virtual void color(std::span<const PatternSample> samples) const = 0;
    /// Mean of the channels, where that is largest; an estimate.
    virtual float largest() const = 0;
};

/// Of the nodes of a scene's lights: [lights], nullptr where there are none; empty: nowhere.
using LightPatterns = std::vector<std::shared_ptr<const LightPattern>>;

}  // namespace granita
