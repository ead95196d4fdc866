// SPDX-License-Identifier: GPL-3.0-or-later
// Attributes of curves and points at a place along them.
#pragma once

#include <cstdint>

#include "geometry/attribute_request.h"
#include "geometry/shared_elements.h"

namespace granita {

/// Where along a row of control points: `point` and this part of the way to `next`.
struct ElementPlace {
    std::uint32_t element = 0;
    std::size_t point = 0, next = 0;
    double fraction = 0.0;
};

/// A number in [0, 1] of an index, as Cycles hashes curves, points and particles.
float random_of_index(std::uint32_t index);

/// Fills `out` [request.width]; zeros where the geometry has nothing of that name.
void element_value(const SharedElements& elements, const AttributeRequest& request,
                   const ElementPlace& place, float* out);

}  // namespace granita
