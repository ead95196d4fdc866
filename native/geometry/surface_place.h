// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/shared_geometry.h"

namespace granita {

/// A place on a patch of a geometry.
struct SurfacePlace {
    const BasePatch* patch = nullptr;  ///< nullptr: the patch that is spoken of
    Vec2d uv{0.0};
};

}  // namespace granita
