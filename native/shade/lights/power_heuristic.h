// SPDX-License-Identifier: GPL-3.0-or-later
// What samples of one kind count for beside another's that may find the same light: by squares of
// their densities (Veach 1997, section 9.2.4), as in Cycles.  Where some rays meet what others
// pass, so that the two do not find the same, the picture is Cycles' only then.
#pragma once

namespace granita {

/// Of light that samples of density `own` > 0 find, the part that is theirs.
inline float power_share(float own, float other) {
    const float ratio = other / own;
    return 1.0f / (1.0f + ratio * ratio);
}

/// What to divide light by that a sample of density `own` > 0 has found.
inline float power_density(float own, float other) {
    const float ratio = other / own;
    return own * (1.0f + ratio * ratio);
}

}  // namespace granita
