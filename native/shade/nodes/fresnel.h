// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace granita {

/// Unpolarised reflectance of a smooth dielectric boundary, exact (Cook and Torrance 1982).
/// `ior` of the far side relative to the near one.
float dielectric_reflectance(float cosine, float ior);

}  // namespace granita
