// SPDX-License-Identifier: GPL-3.0-or-later
// Runs of the sample table's scrambled Sobol numbers (sample_bits.h), compiled for every SIMD
// target and chosen at run time (Highway).
#pragma once

#include <cstddef>
#include <cstdint>

namespace granita {

/// Numbers come in so many at a time.
inline constexpr std::size_t kSobolRun = 16;

/// One dimension of the table, and what its runs are made of: once a frame, as with few samples it
/// would cost as much as all the rest of a tile's numbers.
struct SobolDimension {
    /// @param square_digits of bits::sequence_place.  @param kept binary digits.
    SobolDimension(int dimension, std::uint32_t square_digits, int kept);
    /// Before it is scrambled.
    std::uint32_t point(std::uint32_t i) const;

    std::uint32_t number, square_digits;
    int digits;
    std::uint32_t within[kSobolRun];  ///< the lowest digits of the index choose within a run
    /// From run to run all direction numbers up to the lowest zero bit of the rest toggle.
    std::uint32_t toggle[32] = {};
};

/// owen(sobol_reversed(sequence_place(first + i)), seed) as a fraction into out[i] for i < count.
/// `first` and `count` are multiples of kSobolRun.
void fill_sobol(const SobolDimension& dimension, std::uint32_t seed, std::uint32_t first,
                std::size_t count, float* out);

}  // namespace granita
