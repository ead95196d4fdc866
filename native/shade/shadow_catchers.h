// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that stand for what is in a plate.  What is composed in takes from their light, by its
// shadows, or adds to it; what is left of it, by channel, is the same light over that of the
// plate's own surfaces and lamps alone, as Cycles has it.  Its film divides two pictures; here each
// point divides its own light, by the same samples where both are lit by as many, so that what
// nothing shadows is 1 and not noise.
#pragma once

#include <span>

#include "shade/grid_channels.h"
#include "shade/lights/lamp_sight.h"
#include "shade/shading_system.h"

namespace granita {

class ShadowCatchers {
  public:
    /// `scene` has some.
    ShadowCatchers(const Scene& scene, Statistics& statistics, const Progress& progress);

    /// Turns the radiance of a grid of theirs, just shaded, into what is left of it, and its
    /// `noise` [points] (or empty) and the light of its `sights` into those of this.
    void divide(Grid& grid, const ChannelSet& channels, std::span<float> noise,
                std::span<LampSight> sights) const;
    /// The same of samples in it.
    void divide(Grid& samples, const Grid& grid, std::span<const RefinedPoint> wanted,
                const ChannelSet& channels) const;

  private:
    Scene m_scene;
    Report m_unsaid;  ///< the whole scene's shading says it
    ShadingSystem m_shading;
};

}  // namespace granita
