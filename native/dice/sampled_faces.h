// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "dice/knots.h"
#include "geometry/shared_geometry.h"

namespace granita {

/// Which faces of a mesh the frame's samples meet, told where it has many more faces than samples:
/// opening all of them is most of such a picture's cost, and most of them nothing sees.
class SampledFaces {
  public:
    virtual ~SampledFaces() = default;
    /// Patches, ascending, of an instance of polygons that deforms or is carried, but not both;
    /// those that no sample meets may be left out.  nullopt: all are to be opened.  Depends on the
    /// frame alone, not on buckets or crop.  Thread-safe.
    virtual std::optional<std::vector<std::uint32_t>> of(
        std::size_t instance, const std::shared_ptr<const SharedGeometry>& shared,
        const Knots& knots) const = 0;
};

}  // namespace granita
