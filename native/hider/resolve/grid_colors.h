// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hider/sample_store.h"

namespace granita {

/// The opaque grids of a bucket that have one colour, the same at every vertex: what sees them
/// takes it, wherever and whenever it meets them, and nothing is projected.
class GridColors {
  public:
    /// Of the pool's grids that are seen [slots]; once, when those are shaded.
    void fill(const GridPool& pool, const std::vector<bool>& seen);
    /// Whether there is any such grid.
    bool any() const { return m_any; }
    /// Colours the samples that see one and sets done[sample] to 1; leaves the depth.  Returns
    /// whether others see any surface.
    /// @param ids,colors,done [samples].
    bool color(const GridPool& pool, std::span<const SurfaceId> ids, SampleColors& colors,
               std::span<std::uint8_t> done) const;

  private:
    struct Lookup {
        Vec3f color{0.0f};
        std::uint32_t known = 0;
    };
    bool m_any = false;
    std::vector<Lookup> m_lookups;  ///< by the grid's slot in the pool
};

}  // namespace granita
