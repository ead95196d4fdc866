// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace granita {

/// Coefficients of Hosek and Wilkie's sky in XYZ: [colour 3][albedo 0, 1][turbidity 1 to 10]
/// [control point of the elevation 6][coefficient 9].
extern const std::array<float, 3240> kHosekWilkieShape;
/// Its mean radiance, W / (m^2 sr nm): [colour 3][albedo 0, 1][turbidity 1 to 10][control point 6].
extern const std::array<float, 360> kHosekWilkieRadiance;

}  // namespace granita
