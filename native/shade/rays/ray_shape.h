// SPDX-License-Identifier: GPL-3.0-or-later
// A geometry of the scene as Embree takes it: view-independent, object space, at the frame time or,
// where it deforms, at each of its knots (decision 12).
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <string>
#include <vector>

#include "shade/rays/ray_hit.h"
#include "shade/rays/ray_primitives.h"

namespace granita {

class RayShape {
  public:
    virtual ~RayShape() = default;
    /// Embree's own copies, to be committed and released by the caller and numbered as they come;
    /// what only they need is given back here.  Empty: nothing to meet, or not enough memory (the
    /// device's error tells).
    virtual std::vector<RayPart> hand_over(RTCDevice device) = 0;
    /// How much there is of it, for messages: "12 triangles".
    virtual std::string size() const = 0;
    /// 1 = it does not deform.
    virtual int knots() const = 0;
    /// Largest absolute coordinate of a face, or batch: the rounding of rays that meet it grows
    /// with that, not with what else the geometry holds.
    virtual float extent(std::uint32_t face) const = 0;
    /// Largest distance between the surface of a face, or batch, and what rays meet of it at any
    /// knot, object space.
    virtual float error(std::uint32_t face) const = 0;
    /// Fills the place of a hit and its material slot.  `geometry`: which of hand_over()'s.
    virtual void locate(std::uint32_t geometry, std::uint32_t primitive, float u, float v,
                        RayHit& hit) const = 0;
    virtual std::size_t bytes() const = 0;
};

}  // namespace granita
