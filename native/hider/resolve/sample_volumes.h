// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace granita {

/// What lies between a layer of a sample's list, or what is behind the list, and the layer before
/// that.
struct SampleVolume {
    Vec3f transmittance{1.0f};  ///< from there to the camera
    // Light that it sends to the camera, but for the layers before it.
    Vec3f emitted{0.0f};
    Vec3f direct{0.0f};    ///< scattered, of what sends it there
    Vec3f indirect{0.0f};  ///< scattered, by way of surfaces and other places

    Vec3f light() const { return emitted + direct + indirect; }
};

/// Of all samples of a tile, or empty: nothing is filled.  What is before their layers is there for
/// channels alone: colours have it in the looks of the layers.
class SampleVolumes {
  public:
    bool empty() const { return m_ends.empty(); }
    void reserve(std::size_t samples, std::size_t layers) {
        m_volumes.reserve(samples + layers);
        m_ends.reserve(samples);
    }
    /// Of the sample after those that are there: before each layer or none, then before what is
    /// behind.
    void add(const SampleVolume& volume) { m_volumes.push_back(volume); }
    void end_sample() { m_ends.push_back(static_cast<std::uint32_t>(m_volumes.size())); }

    std::uint64_t bytes() const {
        return m_volumes.capacity() * sizeof(SampleVolume) +
               m_ends.capacity() * sizeof(std::uint32_t);
    }
    const SampleVolume& before_layer(std::uint32_t sample, std::uint32_t k) const {
        return m_volumes[(sample == 0 ? 0 : m_ends[sample - 1]) + k];
    }
    const SampleVolume& behind(std::uint32_t sample) const { return m_volumes[m_ends[sample] - 1]; }

  private:
    std::vector<SampleVolume> m_volumes;
    std::vector<std::uint32_t> m_ends;  ///< [samples] in m_volumes
};

}  // namespace granita
