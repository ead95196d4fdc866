// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of one pixel, weighed for every pixel whose filter reaches them.  Compiled for every
// SIMD target and chosen at run time (Highway); all targets give the same bits: colours are summed
// in eight lanes in a fixed order, channels one sample after another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hider/sample_channels.h"

namespace granita {

/// A pixel filter over distance, linear between steps; a BOX as it is.
struct FilterTable {
    const float* pairs = nullptr;  ///< [steps + 1] a step's value, and its rise to the next step's
    int steps = 0;
    float steps_a_pixel = 0.0f;
    bool is_box = false;
    float radius = 0.0f, height = 0.0f;  ///< of a BOX; it holds its left end
};

/// Sums over the samples of a pixel.
struct WeightedSum {
    float r = 0.0f, g = 0.0f, b = 0.0f, a = 0.0f, weight = 0.0f;
};

/// The pixels within reach of a pixel, as a square: `taps` a side, row by row from the lower left.
struct PixelWork {
    PixelWork(int samples_a_pixel, int taps_each_side, int channel_width);

    int samples, padded, each_side, taps, width;
    std::vector<float> x, y;  ///< [padded] from the pixel's centre; infinity at the end
    std::vector<float> red, green, blue, alpha;  ///< [padded]; 0 at the end
    const float* rows = nullptr;  ///< [samples][width] channels, then SampleChannels::kPadding
    std::vector<float> weights_x, weights_y,
        weights;                    ///< [taps][padded] twice; [taps * taps][padded]
    std::vector<WeightedSum> sums;  ///< [taps * taps]
    std::vector<float> row_sums;    ///< [taps * taps][width]
};

/// Fills the sums.  The weight of a sample is the product of its two factors and `share`.
void weigh_pixel(const FilterTable& filter, float share, PixelWork& work);

}  // namespace granita
