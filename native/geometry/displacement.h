// SPDX-License-Identifier: GPL-3.0-or-later
// How materials move the surfaces of instances (decision 6), as dicing and rays ask for it.
//
// An offset is a function of the instance and of a place on its geometry, and of nothing else: not
// of grids, rates or who asks.  What changes of it is told between places as far apart as
// micropolygons are.  What two patches share is moved as the patch that owns it says
// (PatchBorders), so that both have the same bits (decision 10).
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "geometry/surface_place.h"

namespace granita {

/// Of the coordinates: offsets at places that are closer differ by the rounding of single
/// precision.
inline constexpr double kLeastDifference = 2e-5;

/// Offsets at n places, object space, at the frame time; they hold throughout the shutter, as in
/// Cycles.
struct Offsets {
    std::vector<Vec3f> offset;
    std::vector<Vec3f> by_u, by_v;  ///< derivatives of the patch, where they were asked for
};

/// Thread-safe; instances by their index in Scene::instances.
class Displacement {
  public:
    virtual ~Displacement() = default;
    virtual bool displaces(std::size_t instance) const = 0;
    /// No offset of the instance is longer, object space.
    virtual float bound(std::size_t instance) const = 0;
    /// The instance whose offsets this one's are, but for how finely textures are read: to rays
    /// one shape may stand for both.
    virtual std::size_t same_as(std::size_t instance) const = 0;
    /// Shared by those of several pictures whose offsets are all the same; nullptr: by none.
    virtual std::shared_ptr<const void> identity() const { return nullptr; }
    /// On any patches; a call for many places costs a fraction of a call for each.
    virtual void find(std::size_t instance, const SharedGeometry& geometry,
                      std::span<const SurfacePlace> places, bool derivatives,
                      Offsets& out) const = 0;
    /// At places beside patches, which only tell slopes: nothing is moved there, so that no bound
    /// holds and nothing is said of them.
    virtual void find_beside(std::size_t instance, const SharedGeometry& geometry,
                             std::span<const SurfacePlace> places, Offsets& out) const {
        find(instance, geometry, places, false, out);
    }
};

}  // namespace granita
