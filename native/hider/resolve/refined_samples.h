// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/resolve/surface_interpolator.h"

namespace granita {

/// The samples of a tile whose surface behind all lists was shaded for each by itself
/// (ShadingSystem::refine).
class RefinedSamples {
  public:
    /// `count`: of the tile's samples.  The grid outlives this.
    void add(std::uint32_t sample, std::size_t count, const Grid& grid, int vertex) {
        m_index.resize(count, kNone);
        m_index[sample] = static_cast<std::uint32_t>(m_points.size());
        m_samples.push_back(sample);
        m_points.push_back({&grid, {vertex, vertex, vertex}, {1.0f, 0.0f, 0.0f}});
    }
    const std::vector<std::uint32_t>& samples() const { return m_samples; }
    const SurfacePoint& point(std::size_t index) const { return m_points[index]; }
    /// nullptr: the sample's surface is as interpolated.
    const SurfacePoint* find(std::uint32_t sample) const {
        if (m_index.empty() || m_index[sample] == kNone) return nullptr;
        return &m_points[m_index[sample]];
    }

  private:
    static constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> m_index;    ///< [samples]; empty: none
    std::vector<std::uint32_t> m_samples;  ///< of the points
    std::vector<SurfacePoint> m_points;
};

}  // namespace granita
