// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hider/resolve/sample_channels.h"
#include "hider/resolve/sample_volumes.h"
#include "hider/resolve/surface_interpolator.h"

namespace granita {

/// The channels of one tile's samples while composite_tile puts their layers over each other.
/// Transmission: the share of light, a channel, that reaches the eye from the layer at hand.
class ChannelLayers {
  public:
    /// Sizes `out` and fills it with 0.
    ChannelLayers(const ChannelSet& channels, const TileSamples& samples, SampleChannels& out);

    /// What is premultiplied of a layer.
    void add(std::uint32_t sample, const SurfacePoint& at, const Vec3d& transmission);
    /// The layer that stands for the sample where nothing is mixed.
    void set_first(std::uint32_t sample, const SurfacePoint& at);
    /// The light that it sends.
    void add_volume(std::uint32_t sample, const SampleVolume& volume, const Vec3d& transmission);
    void add_environment(std::uint32_t sample, const Vec3f& radiance, const Vec3d& transmission);

  private:
    const ChannelSet& m_channels;
    SampleChannels& m_out;
    CenterSamples m_centers;
    std::uint32_t m_samples;
    int m_interpolated_center = 0;  ///< floats of [Center] before [CenterConstant]
};

}  // namespace granita
