// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

namespace granita {

/// Into [0, 1]; what is no number becomes 0.
inline float saturate(float x) {
    return x > 0.0f ? std::min(x, 1.0f) : 0.0f;
}

}  // namespace granita
