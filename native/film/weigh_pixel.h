// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of one pixel, weighed for every pixel whose filter reaches them.  Compiled for every
// SIMD target and chosen at run time (Highway); all targets give the same bits: colours are summed
// in sixteen lanes in a fixed order, channels one sample after another.
#pragma once

#include <cstddef>
#include <vector>

#include "film/filter_pieces.h"
#include "hider/resolve/sample_channels.h"
#include "hider/sample_store.h"

namespace granita {

/// Sums over the samples of a pixel.
struct WeightedSum {
    float r = 0.0f, g = 0.0f, b = 0.0f, a = 0.0f, weight = 0.0f;
};

/// The samples of one pixel and the pixels within reach of it, a square: `taps` a side, row by row
/// from the lower left.
class PixelWork {
  public:
    static constexpr int kLanes = 16;  ///< in which colours are summed, on every target

    PixelWork(int samples_a_pixel, int taps_each_side, int channel_width);

    /// The samples from `first` on belong to the pixel with this centre (relative to the tile).
    /// `rows`: their channels, then SampleChannels::kPadding.
    void load(const TileSamples& samples, const SampleColors& colors, std::size_t first,
              Vec2f pixel_center, const float* rows);

    const int samples, padded, each_side, taps, width;
    /// [padded] infinity, and 0 for colours, at the end.
    const float *x = nullptr, *y = nullptr, *red = nullptr, *green = nullptr, *blue = nullptr,
                *alpha = nullptr;
    Vec2f center{0.0f};
    const float* rows = nullptr;  ///< [samples][width]
    std::vector<float> weights_x, weights_y,
        weights;  ///< [taps][padded] twice; [taps * taps][padded] where there are channels
    std::vector<WeightedSum> sums;  ///< [taps * taps]
    std::vector<float> row_sums;    ///< [taps * taps][width]

  private:
    std::vector<float> m_copies[6];  ///< of the samples, where they do not fill whole vectors
};

/// Fills the sums.  The weight of a sample is the product of its two factors and `share`.
void weigh_pixel(const FilterPieces& filter, float share, PixelWork& work);

}  // namespace granita
