// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient noise (Perlin 2002) in one to four dimensions and its sum over octaves (fBm), with the
// hash, the gradients and the scales of Blender's textures.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "math/hash.h"

namespace granita {

template <std::size_t N>
using NoisePoint = std::array<float, N>;

namespace noise_detail {

inline float signed_by(float x, std::uint32_t bit) {
    return bit ? -x : x;
}

/// Dot product of the corner's gradient with the offset from it.
template <std::size_t N>
float gradient(std::uint32_t hash, const NoisePoint<N>& d) {
    if constexpr (N == 1) {
        const std::uint32_t h = hash & 15u;
        return signed_by(static_cast<float>(1u + (h & 7u)), h & 8u) * d[0];
    } else if constexpr (N == 2) {
        const std::uint32_t h = hash & 7u;
        const float u = h < 4 ? d[0] : d[1], v = 2.0f * (h < 4 ? d[1] : d[0]);
        return signed_by(u, h & 1u) + signed_by(v, h & 2u);
    } else if constexpr (N == 3) {
        const std::uint32_t h = hash & 15u;
        const float u = h < 8 ? d[0] : d[1];
        const float v = h < 4 ? d[1] : (h == 12 || h == 14 ? d[0] : d[2]);
        return signed_by(u, h & 1u) + signed_by(v, h & 2u);
    } else {
        const std::uint32_t h = hash & 31u;
        const float u = h < 24 ? d[0] : d[1], v = h < 16 ? d[1] : d[2], s = h < 8 ? d[2] : d[3];
        return signed_by(u, h & 1u) + signed_by(v, h & 2u) + signed_by(s, h & 4u);
    }
}

/// What brings the noise of N dimensions to [-1, 1].
constexpr std::array<float, 4> kScales{0.25f, 0.6616f, 0.9820f, 0.8344f};

}  // namespace noise_detail

/// In [-1, 1], 0 at the lattice points.
template <std::size_t N>
float signed_noise(const NoisePoint<N>& p) {
    std::array<float, N> cell, inside, weight;
    for (std::size_t c = 0; c < N; ++c) {
        cell[c] = std::floor(p[c]);
        inside[c] = p[c] - cell[c];
        const float t = inside[c];
        weight[c] = t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
    }
    std::array<float, std::size_t{1} << N> value;
    for (std::size_t corner = 0; corner < value.size(); ++corner) {
        std::array<std::uint32_t, N> lattice;
        NoisePoint<N> offset;
        for (std::size_t c = 0; c < N; ++c) {
            const auto step = static_cast<std::uint32_t>(corner >> c & 1u);
            // Through 64 bits: lattice points beyond 2^31 wrap, they do not overflow.
            lattice[c] = static_cast<std::uint32_t>(
                             static_cast<std::int64_t>(std::clamp(cell[c], -1e18f, 1e18f))) +
                         step;
            offset[c] = inside[c] - static_cast<float>(step);
        }
        value[corner] = noise_detail::gradient<N>(hash_words(lattice), offset);
    }
    std::size_t left = value.size();
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
