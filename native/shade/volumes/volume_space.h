// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/vec.h"
#include "scene/geometry_data.h"

namespace granita {

/// A geometry as its inside is asked of: Generated coordinates of places in its own space.
struct VolumeSpace {
    Vec3f scale{1.0f}, offset{0.0f};
    Vec3f size{0.0f};  ///< of the box of its points

    /// Of its points at `knot`.
    VolumeSpace(const GeometryData& data, int knot);
    Vec3f generated(const Vec3f& p) const { return p * scale + offset; }
};

}  // namespace granita
