// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/tile_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hider/samples/sample_bits.h"
#include "math/displayed.h"

namespace granita {
namespace {

constexpr int kPlanes = 4;
constexpr int kQuarterSide = kTileSize / 2;

/// [samples of a pixel] the half that each is of.
std::vector<std::uint8_t> halves(const TileSamples& samples) {
    const auto count = static_cast<std::uint32_t>(samples.samples);
    const auto digits = static_cast<std::uint32_t>(samples.square_digits);
    std::vector<std::uint8_t> half(count);
    for (std::uint32_t s = 0; s < count; ++s)
        half[s] = 2 * bits::sequence_place(s, digits) >= count;
    return half;
}

}  // namespace

float tile_noise(const TileSamples& samples, const SampleColors& colors) {
    const auto count = static_cast<std::size_t>(samples.samples);
    if (count < 2) return INFINITY;
    const std::vector<std::uint8_t> half = halves(samples);
    const auto second = static_cast<float>(std::count(half.begin(), half.end(), 1));
    const float scale[2] = {1.0f / (static_cast<float>(count) - second), 1.0f / second};
    const std::array<const float*, kPlanes> planes{colors.red.data(), colors.green.data(),
                                                   colors.blue.data(), colors.alpha.data()};
    double quarters[4] = {};
    for (int pixel = 0; pixel < kTileSize * kTileSize; ++pixel) {
        double squares = 0.0;
        for (const float* const plane : planes) {
            const float* const values = plane + static_cast<std::size_t>(pixel) * count;
            float sums[2] = {};
            for (std::size_t s = 0; s < count; ++s) sums[half[s]] += values[s];
            const float difference =
                0.5f * (displayed(sums[0] * scale[0]) - displayed(sums[1] * scale[1]));
            squares += difference * difference;
        }
        const int row = pixel / kTileSize / kQuarterSide, column = pixel % kTileSize / kQuarterSide;
        quarters[2 * row + column] += squares / kPlanes;
    }
    const double most = *std::max_element(std::begin(quarters), std::end(quarters));
    return static_cast<float>(std::sqrt(most / (kQuarterSide * kQuarterSide)));
}

}  // namespace granita
