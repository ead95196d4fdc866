// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "hider/resolve/grid_colors.h"
#include "hider/sample_store.h"

namespace granita {

/// Opacity and radiance of a vertex (radiance 0 where the grid has none), and two unused floats.
using LayerRow = std::array<float, 8>;

/// What a transparent micropolygon looks like, wherever on it.
struct alignas(32) LayerLook {
    enum : std::uint32_t {
        kVaries = 1,   ///< its corners differ
        kColored = 2,  ///< and the channels of its opacity
        kHoldout = 4,
    };
    union {
        float value[6];        ///< opacity within [0, 1], and radiance; 0 where it is a holdout
        std::uint32_t row[4];  ///< of the corners, where it varies
    };
    std::uint32_t flags = 0;

    LayerLook() : value{} {}
};

/// 0 for what is not a number.
inline float clamp_opacity(float x) {
    return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f;
}

/// Of one opacity and radiance all over.
inline LayerLook look_of(const Vec3f& opacity, const Vec3f& radiance, bool holdout) {
    LayerLook look;
    for (int c = 0; c < 3; ++c) {
        look.value[c] = clamp_opacity(opacity[c]);
        look.value[3 + c] = holdout ? 0.0f : radiance[c];
    }
    if (holdout) look.flags |= LayerLook::kHoldout;
    if (opacity.x != opacity.y || opacity.x != opacity.z) look.flags |= LayerLook::kColored;
    return look;
}

/// The looks of a bucket's transparent micropolygons, once they are shaded: side by side, so that
/// lists, which meet them in any order, find each in one place.
class LayerTable {
  public:
    /// Of the grids that the pool holds when the table is first filled.
    /// @param seen by slot: whether a sample sees the grid, and it is shaded.  Nothing of the
    /// others is read, which another bucket's thread may be shading.
    LayerTable(const GridPool& pool, std::vector<bool> seen)
        : m_pool(pool), m_seen(std::move(seen)) {}
    ~LayerTable();
    LayerTable(const LayerTable&) = delete;
    LayerTable& operator=(const LayerTable&) = delete;
    /// Once, as most buckets have no lists.
    void fill();
    /// Of the grids that the pool holds when they are first asked for.
    const GridColors& grid_colors();

    const GridPool& pool() const { return m_pool; }
    const LayerLook& look(SurfaceId id) const { return m_lookups[id]; }
    const float* row(std::uint32_t index) const { return m_rows[index].data(); }

  private:
    void add(const Grid& grid, SurfaceId base);

    const GridPool& m_pool;
    const std::vector<bool> m_seen;
    bool m_filled = false, m_has_colors = false;
    GridColors m_colors;
    std::vector<LayerLook> m_lookups;  ///< by id
    std::vector<LayerRow> m_rows;
};

}  // namespace granita
