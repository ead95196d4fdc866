// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of the sample table's scrambled Sobol numbers (sample_bits.h), compiled for every SIMD
// target and chosen at run time (Highway).
#pragma once

#include <cstddef>
#include <cstdint>

namespace granita {

/// Numbers come in so many at a time.
inline constexpr std::size_t kSobolRun = 16;

/// The upper `digits` binary digits of owen(sobol_reversed(first + i, dimension), seed), as a
/// fraction, into out[i] for i < count.  `first` and `count` are multiples of kSobolRun.
void fill_sobol(std::uint32_t first, std::size_t count, int dimension, std::uint32_t seed,
                int digits, float* out);

}  // namespace granita
