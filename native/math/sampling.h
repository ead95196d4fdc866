// SPDX-License-Identifier: GPL-3.0-or-later
// Deterministic sample points and the maps from the unit square that lighting uses.  Everything is
// a function of its arguments: the same grid gets the same points on any thread, in any bucket.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "math/vec.h"

namespace granita {

constexpr float kPi = 3.14159265358979f;
constexpr float kInversePi = 0.318309886183791f;

/// Mixes all bits (the finaliser of MurmurHash3, Appleby 2008).
inline std::uint64_t mix_bits(std::uint64_t x) {
    x = (x ^ (x >> 33)) * 0xff51afd7ed558ccdULL;
    x = (x ^ (x >> 33)) * 0xc4ceb9fe1a85ec53ULL;
    return x ^ (x >> 33);
}

/// In [0, 1), by the highest of random bits.
inline float unit_float(std::uint64_t bits) {
    return static_cast<float>(bits >> 40) * 0x1p-24f;
}

/// The bits of x and y interleaved: places along Morton's curve, which visits aligned squares
/// whole.
inline std::uint32_t morton_index(std::uint32_t x, std::uint32_t y) {
    const auto spread = [](std::uint32_t v) {
        v &= 0xffffu;
        v = (v | (v << 8)) & 0x00ff00ffu;
        v = (v | (v << 4)) & 0x0f0f0f0fu;
        v = (v | (v << 2)) & 0x33333333u;
        return (v | (v << 1)) & 0x55555555u;
    };
    return spread(x) | (spread(y) << 1);
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    return __builtin_bswap32(x);
}

/// A generator matrix of Sobol's sequence: exclusive-ors the columns at an index's bits, a byte of
/// them at a time.  Gives the bits in reverse, as Owen's scramble wants them.
class SobolMatrix {
  public:
    explicit constexpr SobolMatrix(const std::array<std::uint32_t, 32>& columns) {
        for (std::size_t byte = 0; byte < 4; ++byte)
            for (std::uint32_t value = 1; value < 256; ++value) {
                const std::uint32_t rest = value & (value - 1);
                const auto bit = static_cast<std::size_t>(std::countr_zero(value));
                m_sums[byte][value] = m_sums[byte][rest] ^ reverse_bits(columns[8 * byte + bit]);
            }
    }
    constexpr std::uint32_t operator()(std::uint32_t index) const {
        return m_sums[0][index & 255u] ^ m_sums[1][index >> 8 & 255u] ^
               m_sums[2][index >> 16 & 255u] ^ m_sums[3][index >> 24];
    }

  private:
    std::array<std::array<std::uint32_t, 256>, 4> m_sums{};
};

/// Of the primitive polynomial x + 1.
inline constexpr SobolMatrix kSobolSecond([] {
    std::array<std::uint32_t, 32> columns{1u << 31};
    for (std::size_t i = 1; i < 32; ++i) columns[i] = columns[i - 1] ^ (columns[i - 1] >> 1);
    return columns;
}());
/// Of x^2 + x + 1.
inline constexpr SobolMatrix kSobolThird([] {
    std::array<std::uint32_t, 32> columns{1u << 31, 3u << 30};
    for (std::size_t i = 2; i < 32; ++i)
        columns[i] = columns[i - 1] ^ columns[i - 2] ^ (columns[i - 2] >> 2);
    return columns;
}());

/// The first three dimensions of Sobol's sequence, Owen-scrambled by hashing (Laine and Karras
/// 2011; Burley 2020).  Any power-of-two prefix of the first two is a (0, m, 2)-net: stratified in
/// every elementary interval.
class SobolPoints {
  public:
    explicit SobolPoints(std::uint64_t seed)
        : m_seed_x(static_cast<std::uint32_t>(mix_bits(seed))),
          m_seed_y(static_cast<std::uint32_t>(mix_bits(seed + 0x632be59bd9b4e019ULL))),
          m_seed_z(static_cast<std::uint32_t>(mix_bits(seed + 0xc6bc279692b5c323ULL))) {}

    /// The same net in every aligned run of a power of two, in an order of its own (Burley 2020,
    /// section 5): what goes by the same index elsewhere, a sample's place in its pixel or its
    /// time, is then not tied to it.
    SobolPoints shuffled(std::uint64_t seed) const {
        SobolPoints other = *this;
        other.m_order = static_cast<std::uint32_t>(mix_bits(seed)) | 1u;
        return other;
    }

    /// The same sequence, of which index 0 is what is `first` here.
    SobolPoints from(std::uint32_t first) const {
        SobolPoints later = *this;
        later.m_first += first;
        return later;
    }
    /// In [0, 1)^2.
    Vec2f operator()(std::uint32_t index) const {
        index = place(index);
        // van der Corput is the bit reversal of the index.
        return {unit(reverse_bits(scramble(index, m_seed_x))),
                unit(reverse_bits(scramble(kSobolSecond(index), m_seed_y)))};
    }

    /// The third coordinate, in [0, 1).
    float third(std::uint32_t index) const {
        return unit(reverse_bits(scramble(kSobolThird(place(index)), m_seed_z)));
    }

  private:
    /// Each bit is flipped by a hash of the bits below it: a nested scramble of the reversed word.
    static std::uint32_t scramble(std::uint32_t x, std::uint32_t seed) {
        x ^= x * 0x3d20adeau;
        x += seed;
        x *= (seed >> 16) | 1u;
        x ^= x * 0x05526c56u;
        x ^= x * 0x53a22864u;
        return x;
    }
    std::uint32_t place(std::uint32_t index) const {
        index += m_first;
        return m_order == 0 ? index : reverse_bits(scramble(reverse_bits(index), m_order));
    }
    static float unit(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

    std::uint32_t m_first = 0, m_seed_x, m_seed_y, m_seed_z;
    std::uint32_t m_order = 0;  ///< 0: as it is
};

/// Axes x, y that make (x, y, n) a right-handed orthonormal frame (Duff et al. 2017).
struct Basis {
    Vec3f x, y, n;
    explicit Basis(const Vec3f& normal) : n(normal) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        x = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
        y = {b, sign + n.y * n.y * a, -n.y};
    }
    Vec3f to_world(const Vec3f& v) const { return v.x * x + v.y * y + v.z * n; }
    Vec3f to_local(const Vec3f& v) const {
        return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, n)};
    }
};

/// Unit disc, area-preserving and with low distortion (Shirley and Chiu 1997).
inline Vec2f sample_disc(const Vec2f& u) {
    const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
    if (a == 0.0f && b == 0.0f) return Vec2f(0.0f);
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b;
    const float phi = wide ? 0.25f * kPi * (b / a) : 0.5f * kPi - 0.25f * kPi * (a / b);
    return {r * std::cos(phi), r * std::sin(phi)};
}

/// Local frame, density cos / pi.
inline Vec3f sample_cosine_hemisphere(const Vec2f& u) {
    const Vec2f d = sample_disc(u);
    return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}

/// Local frame, uniform in the cone about +z; density 1 / (2 pi one_minus_cos).
inline Vec3f sample_cone(const Vec2f& u, float one_minus_cos) {
    const Vec2f d = sample_disc(u);
    const float h = one_minus_cos * (d.x * d.x + d.y * d.y);  // 1 - cos of this direction
    const float scale = std::sqrt(one_minus_cos * std::max(0.0f, 2.0f - h));
    return {d.x * scale, d.y * scale, 1.0f - h};
}

}  // namespace granita
