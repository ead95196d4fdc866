// SPDX-License-Identifier: GPL-3.0-or-later
// The frame as splitting and dicing see it: projection, camera knots, rates, and which attributes
// each material wants at grid vertices.
#pragma once

#include <memory>
#include <vector>

#include "base/statistics.h"
#include "dice/sampled_faces.h"
#include "geometry/attribute_request.h"
#include "geometry/displacement.h"
#include "geometry/geometry_cache.h"
#include "math/projection.h"
#include "scene/scene.h"

namespace granita {

struct View {
    const Scene* scene = nullptr;
    Statistics* statistics = nullptr;
    Projection projection;
    std::vector<std::vector<AttributeRequest>>
        requests;                                ///< [materials + 1], the last for material -1
    const Displacement* displacement = nullptr;  ///< nullptr: nothing is displaced
    bool has_light = true;                       ///< else grids carry nothing for it alone
    std::shared_ptr<const SampledFaces> sampled_faces;  ///< nullptr: all faces are opened

    /// The rectangle that samples can reach through the filter.  Rates do not read it: outside
    /// Options::width and height they coarsen, whatever the crop and the filter.
    float raster_x0 = 0, raster_y0 = 0, raster_x1 = 0, raster_y1 = 0;

    /// What grids of a material (-1: none) carry.
    const std::vector<AttributeRequest>& requests_of(int material) const {
        static const std::vector<AttributeRequest> none;
        if (requests.empty()) return none;
        return material < 0 ? requests.back() : requests[static_cast<std::size_t>(material)];
    }

    /// What instances of one geometry share, built when first asked for.
    std::shared_ptr<GeometryCache> geometries = std::make_shared<GeometryCache>();
};

}  // namespace granita
