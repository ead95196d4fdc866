// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "math/vec.h"

namespace granita {

/// Light that the points of a grid have found: samples that are shaded by themselves take it from
/// there.
struct GridLight {
    /// [points] what diffuse lobes reflect of other surfaces' light and of the world between them,
    /// by albedo.  Empty: light is not followed so far.  And of that the world's; empty where no
    /// channel tells them apart.
    std::vector<Vec3f> gathered, gathered_world;
    /// [points] likewise what is scattered below the surface, by its weight: light of lamps and the
    /// world, and of other surfaces.
    std::vector<Vec3f> scattered, scattered_bounced;

    /// Numbers of three floats.
    std::size_t size() const {
        return gathered.size() + gathered_world.size() + scattered.size() +
               scattered_bounced.size();
    }
};

}  // namespace granita
