// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient noise (Perlin 2002) in one to four dimensions and its sum over octaves (fBm), with the
// hash, the gradients and the scales of Blender's textures.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "math/four_floats.h"
#include "math/hash.h"

namespace granita {

template <std::size_t N>
using NoisePoint = std::array<float, N>;

// Four corners of a cell at once.
namespace noise_detail {

inline Floats signed_by(const Floats& x, const Words& hash, int bit) {
    return std::bit_cast<Floats>(std::bit_cast<Words>(x) ^ ((hash >> bit) << 31));
}

/// Dot product of the corners' gradients with the offsets from them.
template <std::size_t N>
Floats gradient(const Words& hash, const std::array<Floats, N>& d) {
    if constexpr (N == 1) {
        const Ints size = std::bit_cast<Ints>(hash & 7u) + 1;
        return signed_by(__builtin_convertvector(size, Floats), hash, 3) * d[0];
    } else if constexpr (N == 2) {
        const Ints h = std::bit_cast<Ints>(hash & 7u);
        const Floats u = h < 4 ? d[0] : d[1], v = 2.0f * (h < 4 ? d[1] : d[0]);
        return signed_by(u, hash, 0) + signed_by(v, hash, 1);
    } else if constexpr (N == 3) {
        const Ints h = std::bit_cast<Ints>(hash & 15u);
        const Floats u = h < 8 ? d[0] : d[1];
        const Floats v = h < 4 ? d[1] : ((h == 12) | (h == 14)) ? d[0] : d[2];
        return signed_by(u, hash, 0) + signed_by(v, hash, 1);
    } else {
        const Ints h = std::bit_cast<Ints>(hash & 31u);
        const Floats u = h < 24 ? d[0] : d[1], v = h < 16 ? d[1] : d[2], s = h < 8 ? d[2] : d[3];
        return signed_by(u, hash, 0) + signed_by(v, hash, 1) + signed_by(s, hash, 2);
    }
}

/// What brings the noise of N dimensions to [-1, 1].
constexpr std::array<float, 4> kScales{0.25f, 0.6616f, 0.9820f, 0.8344f};
/// That is, nearly: no noise is larger, were all its corners' gradients those that are longest at a
/// place (the largest over a lattice of places, of 41 a side in four dimensions, rounded up).
constexpr std::array<float, 4> kMost{1.0f, 1.0f, 1.02f, 1.30f};

}  // namespace noise_detail

/// In [-1, 1], 0 at the lattice points.
template <std::size_t N>
float signed_noise(const NoisePoint<N>& p) {
    using namespace noise_detail;
    std::array<float, N> inside, weight;
    std::array<std::uint32_t, N> lattice;
    for (std::size_t c = 0; c < N; ++c) {
        const float cell = std::floor(p[c]);
        // Through 64 bits: lattice points beyond 2^31 wrap, they do not overflow.
        lattice[c] =
            static_cast<std::uint32_t>(static_cast<std::int64_t>(std::clamp(cell, -1e18f, 1e18f)));
        const float t = inside[c] = p[c] - cell;
        weight[c] = t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
    }
    constexpr std::size_t kCorners = std::size_t{1} << N, kLanes = 4;
    std::array<float, std::max(kCorners, kLanes)> value;
    for (std::size_t first = 0; first < kCorners; first += kLanes) {
        std::array<Words, N> corner;
        std::array<Floats, N> offset;
        for (std::size_t c = 0; c < N; ++c) {
            const Words which = Words{0, 1, 2, 3} + static_cast<std::uint32_t>(first);
            const Words step = which >> static_cast<int>(c) & 1u;
            corner[c] = lattice[c] + step;
            offset[c] = inside[c] - __builtin_convertvector(std::bit_cast<Ints>(step), Floats);
        }
        const Floats values = gradient<N>(hash_words(corner), offset);
        std::memcpy(&value[first], &values, sizeof(values));
    }
    std::size_t left = kCorners;
    for (std::size_t c = 0; c < N; ++c) {
        left /= 2;
        for (std::size_t k = 0; k < left; ++k)
            value[k] = (1.0f - weight[c]) * value[2 * k] + weight[c] * value[2 * k + 1];
    }
    const float noise = noise_detail::kScales[N - 1] * value[0];
    return std::isfinite(noise) ? noise : 0.0f;
}

struct Octaves {
    float detail = 0.0f;      ///< octaves beyond the first; a fraction fades the last one in
    float roughness = 0.5f;   ///< amplitude of an octave relative to the one before
    float lacunarity = 2.0f;  ///< its frequency, likewise
    bool normalize = true;    ///< to [0, 1]
};

template <std::size_t N>
float fractal_noise(const NoisePoint<N>& p, const Octaves& octaves) {
    const float detail = std::clamp(octaves.detail, 0.0f, 15.0f);
    const float fraction = detail - std::floor(detail);
    const int whole = static_cast<int>(detail);
    const int count = fraction > 0.0f ? whole + 2 : whole + 1;
    const auto level = [&](float sum, float most) {
        return octaves.normalize ? 0.5f * sum / most + 0.5f : sum;
    };
    float frequency = 1.0f, amplitude = 1.0f, most = 0.0f, sum = 0.0f, before = 0.0f;
    for (int k = 0; k < count; ++k) {
        before = k > 0 ? level(sum, most) : 0.0f;
        NoisePoint<N> q;
        for (std::size_t c = 0; c < N; ++c) q[c] = frequency * p[c];
        sum += amplitude * signed_noise<N>(q);
        most += amplitude;
        amplitude *= octaves.roughness;
        frequency *= octaves.lacunarity;
    }
    const float all = level(sum, most);
    return fraction > 0.0f ? (1.0f - fraction) * before + fraction * all : all;
}

}  // namespace granita
