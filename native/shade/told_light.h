// SPDX-License-Identifier: GPL-3.0-or-later
// What grids tell each other.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "dice/grid_light.h"
#include "shade/bounces/gathered_light.h"
#include "shade/subsurface/subsurface_light.h"

namespace granita {

struct ToldLight {
    std::optional<ToldGathered> gathered;
    std::optional<ScatteredLight> scattered;

    bool empty() const { return !gathered && !scattered; }
    /// Metres within which grids may tell these points something.
    float reach() const;
    std::size_t bytes() const;
};
using ToldLights = std::vector<std::shared_ptr<const ToldLight>>;  ///< [grids]

/// Fills what `found` has of what was `told` with what neighbours share, in a grid of `points` and
/// with those `around` it.
void share_told(const ShadingPoints& points, const ToldLight& told, const ToldLights& around,
                GridLight& found);

}  // namespace granita
