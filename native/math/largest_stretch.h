// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace granita {

/// No direction becomes longer than by this: the exact largest stretch of turns and scales, an
/// upper bound where there is shear (rows of the Gram matrix bound its eigenvalues).
inline double largest_stretch(const Mat3d& m) {
    const Mat3d gram = glm::transpose(m) * m;
    double most = 0.0;
    for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(gram[c][0]) + std::abs(gram[c][1]) + std::abs(gram[c][2]));
    return std::sqrt(most);
}
inline double largest_stretch(const Mat4d& m) {
    return largest_stretch(Mat3d(m));
}

}  // namespace granita
