// SPDX-License-Identifier: GPL-3.0-or-later
// The pixel filter as the raster executor uses it: on a regular lattice every pixel has the same
// weights, so they are constants of a generated shader (paper, 9.3.6).
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace granita {

/// One axis of a separable filter on a lattice of sub-samples.
struct RasterFilter {
    int lattice = 1;              ///< sub-samples along a pixel's side
    int first = 0;                ///< sub-sample of weights[0]; 0 is the pixel's own lowest
    std::vector<double> weights;  ///< consecutive sub-samples; sum 1

    /// Whole pixels that the filter reaches beyond its own.
    int apron() const;
};

/// `factor`: the filter's 1-D factor at a distance from the pixel's centre, pixels; 0 beyond
/// `radius`. Weights are divided by their sum, as film/ does with the samples of a pixel.
RasterFilter make_raster_filter(int lattice, double radius,
                                const std::function<double(double)>& factor);

/// The weights as the source of a list of floats, for resolve/filter.frag.
std::string weights_source(const RasterFilter& filter);

}  // namespace granita
