// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "shade/lights/lamp_choice.h"

namespace granita {

/// How a point asks a lamp.
struct LampTurn {
    std::uint32_t point = 0;  ///< in the list of lit points
    std::uint32_t lamp = 0;
    LampRate rate{1.0f, 1};
    float sign = 0.0f;  ///< as LitGrid::sign, of all its samples; 0: they have their own
};

}  // namespace granita
