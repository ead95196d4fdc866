// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/resolve/layer_table.h"
#include "hider/resolve/surface_interpolator.h"

namespace granita {

/// The samples of a tile that have surfaces which were shaded for each by itself
/// (ShadingSystem::refine): behind all lists, or layers in them.
class RefinedSamples {
  public:
    /// Behind the sample's list.  `count`: of the tile's samples.  The grid outlives this.
    void add(std::uint32_t sample, std::size_t count, const Grid& grid, int vertex) {
        m_index.resize(count, kNone);
        m_index[sample] = static_cast<std::uint32_t>(m_points.size());
        m_samples.push_back(sample);
        m_points.push_back(point_at(grid, vertex));
    }
    const std::vector<std::uint32_t>& samples() const { return m_samples; }
    const SurfacePoint& point(std::size_t index) const { return m_points[index]; }
    /// nullptr: the sample's surface is as interpolated.
    const SurfacePoint* find(std::uint32_t sample) const {
        if (m_index.empty() || m_index[sample] == kNone) return nullptr;
        return &m_points[m_index[sample]];
    }

    /// Layer k of the list in a slot.  `grid`: where its channels are, nullptr without any; it
    /// outlives this.
    void add_layer(const FragmentLists& lists, std::uint32_t slot, std::uint32_t k,
                   const LayerLook& look, const Grid* grid, int vertex) {
        m_lists.resize(lists.slots(), kNone);
        if (m_lists[slot] == kNone) {
            m_lists[slot] = static_cast<std::uint32_t>(m_layers.size());
            m_layers.resize(m_layers.size() + lists.counts()[slot], kNone);
        }
        m_layers[m_lists[slot] + k] = static_cast<std::uint32_t>(m_looks.size());
        m_looks.push_back(look);
        if (grid) m_layer_points.push_back(point_at(*grid, vertex));
    }
    /// Before change_layer() of so many.
    void reserve_layers(std::size_t count, bool has_channels) {
        m_layers.reserve(count);
        m_looks.reserve(count);
        if (has_channels) m_layer_points.reserve(count);
    }
    /// Layer k of the list in a slot then looks like this, wherever it is met; as add_layer().
    void change_layer(const FragmentLists& lists, std::uint32_t slot, std::uint32_t k,
                      const LayerLook& look, const SurfacePoint* channels) {
        if (const std::uint32_t found = layer(slot, k); found != kNone) {
            m_looks[found] = look;
            return;
        }
        add_layer(lists, slot, k, look, nullptr, 0);
        if (channels) m_layer_points.push_back(*channels);
    }
    std::uint64_t bytes_of_layers() const {
        return m_layers.capacity() * sizeof(std::uint32_t) +
               m_looks.capacity() * sizeof(LayerLook) +
               m_layer_points.capacity() * sizeof(SurfacePoint);
    }
    bool any_layers() const { return !m_looks.empty(); }
    /// What such a layer looks like; nullptr: as its micropolygon does.
    const LayerLook* look(std::uint32_t slot, std::uint32_t k) const {
        const std::uint32_t found = layer(slot, k);
        return found == kNone ? nullptr : &m_looks[found];
    }
    /// Likewise where its channels are.
    const SurfacePoint* layer_point(std::uint32_t slot, std::uint32_t k) const {
        const std::uint32_t found = layer(slot, k);
        return found == kNone ? nullptr : &m_layer_points[found];
    }

  private:
    static constexpr std::uint32_t kNone = ~0u;
    static SurfacePoint point_at(const Grid& grid, int vertex) {
        return {&grid, {vertex, vertex, vertex}, {1.0f, 0.0f, 0.0f}};
    }
    std::uint32_t layer(std::uint32_t slot, std::uint32_t k) const {
        if (m_lists.empty() || m_lists[slot] == kNone) return kNone;
        return m_layers[m_lists[slot] + k];
    }

    std::vector<std::uint32_t> m_index;    ///< [samples]; empty: none
    std::vector<std::uint32_t> m_samples;  ///< of the points
    std::vector<SurfacePoint> m_points;
    std::vector<std::uint32_t> m_lists;   ///< [slots] its first layer in m_layers; empty: none
    std::vector<std::uint32_t> m_layers;  ///< of lists that have any: the look of each layer
    std::vector<LayerLook> m_looks;
    std::vector<SurfacePoint> m_layer_points;  ///< of the looks
};

}  // namespace granita
