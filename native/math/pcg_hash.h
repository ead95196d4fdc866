// SPDX-License-Identifier: GPL-3.0-or-later
// Hashes of a lattice point into as many values as it has coordinates: PCG in two to four
// dimensions (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 2020).  The fold of the
// upper half into the lower keeps the sign, as that of Blender's signed words does.
#pragma once

#include <array>
#include <cstdint>

namespace granita {

namespace pcg_detail {

template <std::size_t N>
void stir(std::array<std::uint32_t, N>& v) {
    constexpr std::uint32_t kFactor = 1664525u;
    if constexpr (N == 2) {
        v[0] += v[1] * kFactor;
        v[1] += v[0] * kFactor;
    } else {
        v[0] += v[1] * v[N - 1];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        if constexpr (N == 4) v[3] += v[1] * v[2];
    }
}

}  // namespace pcg_detail

/// Each in [0, 1].
template <std::size_t N>
std::array<float, N> pcg_hash(const std::array<std::int32_t, N>& cell) {
    static_assert(N >= 2 && N <= 4);
    std::array<std::uint32_t, N> v;
    for (std::size_t c = 0; c < N; ++c)
        v[c] = static_cast<std::uint32_t>(cell[c]) * 1664525u + 1013904223u;
    pcg_detail::stir<N>(v);
    for (std::uint32_t& x : v) x ^= static_cast<std::uint32_t>(static_cast<std::int32_t>(x) >> 16);
    pcg_detail::stir<N>(v);
    std::array<float, N> values;
    for (std::size_t c = 0; c < N; ++c)
        values[c] = static_cast<float>(v[c] & 0x7fffffffu) * (1.0f / 2147483647.0f);
    return values;
}

}  // namespace granita
