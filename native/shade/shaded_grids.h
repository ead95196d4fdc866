// SPDX-License-Identifier: GPL-3.0-or-later
// Grids that an earlier picture has shaded under the same light: one that is equal to one of them
// in all that shading reads takes what that had (docs/decisions/viewport.md).
#pragma once

#include <map>

#include "dice/grid.h"

namespace granita {

class ShadedGrids {
  public:
    /// The grid must outlive the object and keep its shading state.  One that was neither shaded
    /// nor tells anything, or was not finite everywhere, which is to be said again, is left out.
    void add(const Grid& grid);
    bool empty() const { return m_grids.empty(); }
    /// nullptr where none is equal in every byte that Grid has before it is shaded.
    const Grid* find(const Grid& grid) const;

  private:
    std::map<GridKey, const Grid*> m_grids;
};

/// Fills what shading leaves, but for what the grid tells.
void take_shading(const Grid& from, Grid& to);

}  // namespace granita
