// SPDX-License-Identifier: GPL-3.0-or-later
// How shadow rays ask materials what they let through.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "math/vec.h"
#include "shade/rays/ray_hit.h"

namespace granita {

/// Both or neither are given; called from any thread.
struct ShadowOpacity {
    std::function<bool(std::int32_t material)> is_transparent;
    /// What passes the surface: 0 = opaque, 1 = nothing there.
    std::function<Vec3f(const RayHit&)> transparency;
    /// The same of a material where it is one everywhere: places are then not looked up.  May be
    /// missing.
    std::function<std::optional<Vec3f>(std::int32_t material)> constant = nullptr;
};

}  // namespace granita
