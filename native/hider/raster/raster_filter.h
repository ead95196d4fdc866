// SPDX-License-Identifier: GPL-3.0-or-later
// The pixel filter as the raster executor uses it, in a generated shader (paper, 9.3.6): on a
// regular lattice every pixel has the same weights; samples that lie anywhere weigh by a table of
// the filter's factor.  Along a rotated lattice the filter is not separable: its weights are a list
// of texels.
#pragma once

#include <functional>
#include <vector>

#include "hider/samples/regular_lattice.h"

namespace granita {

struct RasterFilter {
    RegularLattice lattice;

    /// One axis of a separable filter on a lattice that is not rotated.
    int first = 0;                ///< sub-sample of weights[0]; 0 is the pixel's own lowest
    std::vector<double> weights;  ///< consecutive sub-samples; sum 1

    /// On a rotated lattice.
    struct Tap {
        Vec2i texel{0, 0};  ///< from RegularLattice::first_texel of the pixel
        float weight = 0.0f;
        float unused = 0.0f;  // std430 on the device
    };
    std::vector<Tap> taps;  ///< sum 1
    int tap_pixels = 0;     ///< that they reach beyond their own

    /// Samples anywhere: the factor at equal steps from 0 to `radius`, unnormalised; else empty.
    std::vector<float> factor;
    double radius = 0.0;
    bool is_box = false;

    /// Whole pixels that the filter reaches beyond its own.
    int margin() const;
};

/// `factor`: the filter's 1-D factor at a distance from the pixel's centre, pixels; 0 beyond
/// `radius`. Weights are divided by their sum, as film/ does with the samples of a pixel.
RasterFilter make_raster_filter(RegularLattice lattice, double radius,
                                const std::function<double(double)>& factor);

/// For samples that lie anywhere in their pixels, of which `lattice`^2 have room.  The table's
/// linear interpolation errs by less than 1e-5 of the factor at 0 for the filters of film/.
RasterFilter make_gathering_filter(int lattice, double radius, bool is_box,
                                   const std::function<double(double)>& factor);

}  // namespace granita
