// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/layer_cache.h"

namespace granita {

void LayerCache::fill(Micropolygon& entry, SurfaceId id) const {
    const GridPool::Place place = m_pool.locate(id);
    const Grid& grid = *place.grid;
    const Grid::Corners c = grid.corners(place.micropolygon);
    entry.id = id;
    entry.grid = &grid;
    for (int i = 0; const int v : {c.v0, c.v1, c.v2, c.v3}) {
        entry.vertex[i] = v;
        const Vec3f& opacity = grid.opacity[v];
        const Vec3f radiance = grid.radiance.empty() ? Vec3f(0.0f) : grid.radiance[v];
        entry.row[i++] = {opacity.x,  opacity.y,  opacity.z, radiance.x,
                          radiance.y, radiance.z, 0.0f,      0.0f};
    }
}

}  // namespace granita
