// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of the sample table's scrambled Sobol numbers (sample_bits.h), compiled for every SIMD
// target and chosen at run time (Highway).
#pragma once

#include <cstddef>
#include <cstdint>

namespace granita {

/// Numbers come in so many at a time.
inline constexpr std::size_t kSobolRun = 16;

/// One dimension of the table.
struct SobolDimension {
    int dimension;
    std::uint32_t seed;
    std::uint32_t square_digits;  ///< bits::sequence_place
    int digits;                   ///< binary digits that are kept
};

/// owen(sobol_reversed(sequence_place(first + i))) as a fraction into out[i] for i < count. `first`
/// and `count` are multiples of kSobolRun.
void fill_sobol(const SobolDimension& dimension, std::uint32_t first, std::size_t count,
                float* out);

}  // namespace granita
