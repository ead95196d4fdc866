// SPDX-License-Identifier: GPL-3.0-or-later
// Texels as they lie in tiles: four channels (colour and alpha) of bytes, half floats or floats.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "math/vec.h"

namespace granita {

enum class TexelType : std::uint8_t { Byte, Half, Float };

/// Of all four channels.
constexpr std::size_t byte_size(TexelType type) {
    return type == TexelType::Byte ? 4 : type == TexelType::Half ? 8 : 16;
}

constexpr float kLargestHalf = 65504.0f;
/// Beyond, sums of texels would not be numbers.
constexpr float kLargestNumber = 1e30f;

/// Exact: the exponent's bias is changed by a product, which makes normal numbers of subnormal ones
/// too.  Infinities and NaN are never stored.
inline float float_from_half(std::uint16_t h) {
    const std::uint32_t magnitude = static_cast<std::uint32_t>(h & 0x7fffu) << 13;
    const std::uint32_t sign = static_cast<std::uint32_t>(h & 0x8000u) << 16;
    const float value = std::bit_cast<float>(magnitude) * 0x1p112f;
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) | sign);
}

/// Rounded to the nearest, ties to even; beyond the largest half, that; of finite numbers only.
inline std::uint16_t half_from_float(float x) {
    const float magnitude = std::min(std::abs(x), kLargestHalf);
    const auto sign = static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(x) >> 16) & 0x8000u);
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(magnitude);
    std::uint32_t half;
    if (magnitude < 0x1p-14f) {
        // Added to 1/2, a step of the last place is that of the smallest half: the sum rounds.
        half = std::bit_cast<std::uint32_t>(magnitude + 0.5f) - std::bit_cast<std::uint32_t>(0.5f);
    } else {
        half = (bits - (112u << 23) + 0xfffu + ((bits >> 13) & 1u)) >> 13;
    }
    return static_cast<std::uint16_t>(half | sign);
}

/// One texel as it is stored: bytes become 0 to 1.
inline Vec4f stored_texel(const std::byte* at, TexelType type) {
    if (type == TexelType::Byte) {
        const auto* c = reinterpret_cast<const std::uint8_t*>(at);
        return Vec4f(c[0], c[1], c[2], c[3]) * (1.0f / 255.0f);
    }
    if (type == TexelType::Half) {
        const auto* c = reinterpret_cast<const std::uint16_t*>(at);
        return {float_from_half(c[0]), float_from_half(c[1]), float_from_half(c[2]),
                float_from_half(c[3])};
    }
    const auto* c = reinterpret_cast<const float*>(at);
    return {c[0], c[1], c[2], c[3]};
}

inline void store_texel(const Vec4f& texel, std::byte* at, TexelType type) {
    if (type == TexelType::Byte) {
        auto* c = reinterpret_cast<std::uint8_t*>(at);
        for (int k = 0; k < 4; ++k)
            c[k] = static_cast<std::uint8_t>(std::clamp(texel[k] * 255.0f + 0.5f, 0.0f, 255.0f));
    } else if (type == TexelType::Half) {
        auto* c = reinterpret_cast<std::uint16_t*>(at);
        for (int k = 0; k < 4; ++k) c[k] = half_from_float(texel[k]);
    } else {
        auto* c = reinterpret_cast<float*>(at);
        for (int k = 0; k < 4; ++k) c[k] = texel[k];
    }
}

}  // namespace granita
