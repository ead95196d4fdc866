// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "hider/surface_interpolator.h"

namespace granita {

/// Opacity and radiance of fragments.  Neighbouring samples meet the same few micropolygons, whose
/// corners are kept side by side: a fragment costs three rows.
class LayerCache {
  public:
    explicit LayerCache(const GridPool& pool) : m_pool(pool) {}

    /// Opacity, radiance (0 where the grid has none) and two unused floats.
    using Row = std::array<float, 8>;
    struct Micropolygon {
        SurfaceId id = kNoSurface;
        const Grid* grid = nullptr;
        int vertex[4] = {};
        Row row[4];
    };

    const Micropolygon& load(SurfaceId id) {
        if (m_entries.empty())
            m_entries.resize(std::size_t{1} << kBits);  // tiles without fragments need none
        Micropolygon& entry = m_entries[place(id)];
        if (entry.id != id) fill(entry, id);
        return entry;
    }

    static Row interpolate(const Micropolygon& at, const Fragment& fragment) {
        const auto [w0, w1, w2] = weights(fragment);
        const int j = fragment.second() ? 2 : 1;
        const Row &a = at.row[0], &b = at.row[j], &c = at.row[j + 1];
        Row out;
        for (int k = 0; k < 8; ++k) out[k] = w0 * a[k] + w1 * b[k] + w2 * c[k];
        return out;
    }

    static SurfacePoint point(const Micropolygon& at, const Fragment& fragment) {
        const auto [w0, w1, w2] = weights(fragment);
        const int j = fragment.second() ? 2 : 1;
        return {at.grid, {at.vertex[0], at.vertex[j], at.vertex[j + 1]}, {w0, w1, w2}};
    }

  private:
    static constexpr int kBits = 9;
    /// Spread (Knuth's multiplicative hash): grids often have 256 micropolygons, so that layers
    /// would lie in each other's places.
    static std::size_t place(SurfaceId id) { return id * 2654435769u >> (32 - kBits); }

    /// None is negative, so that no value leaves the range of its corners (OpacityBounds).
    static std::array<float, 3> weights(const Fragment& fragment) {
        const float b1 = fragment.b1();
        return {std::max(0.0f, 1.0f - b1 - fragment.b2), b1, fragment.b2};
    }
    void fill(Micropolygon& entry, SurfaceId id) const;

    const GridPool& m_pool;
    std::vector<Micropolygon> m_entries;
};

}  // namespace granita
