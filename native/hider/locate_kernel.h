// SPDX-License-Identifier: GPL-3.0-or-later
// Where sixteen samples meet sixteen micropolygons, compiled for every SIMD target (Highway): the
// plain cases of hit_micropolygon (micropolygon.h) with the same bits.
#pragma once

namespace granita {

struct LocateLanes {
    static constexpr int kCount = 16;
    /// Corners as seen from the sample, x and y: Offset<float> of each.
    float x[4][kCount], y[4][kCount];

    // Results.
    double b1[kCount], b2[kCount];  ///< weights of the triangle's second and third corner
    double second[kCount];          ///< 1: triangle (0, 2, 3), 0: (0, 1, 2)
    double plain[kCount];           ///< 1: inside exactly one triangle and on no edge; else 0
};

void locate_lanes(LocateLanes& lanes);

}  // namespace granita
