// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace granita {

/// The air over a place, and the sun in it.  Angles in radians, lengths in metres; densities are
/// relative to those of clear air.
struct Atmosphere {
    float sun_elevation = 0.0f;  ///< -pi / 2 to pi / 2
    float altitude = 0.0f;
    float air = 1.0f, dust = 1.0f, ozone = 1.0f;

    bool operator==(const Atmosphere&) const = default;
};

}  // namespace granita
