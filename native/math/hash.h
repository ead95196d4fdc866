// SPDX-License-Identifier: GPL-3.0-or-later
// Hashes of lattice points: Bob Jenkins' lookup3 (2006, public domain) over one to four words, as
// Blender defines its procedural textures with.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <tuple>

#include "math/vec.h"

namespace granita {

/// `Word`: 32 bits, or several such side by side.
template <class Word, std::size_t N>
Word hash_words(const std::array<Word, N>& k) {
    static_assert(N >= 1 && N <= 4);
    const auto rotl = [](const Word& x, int bits) -> Word {
        return (x << bits) | (x >> (32 - bits));
    };
    const Word start = Word{} + (0xdeadbeefu + (static_cast<std::uint32_t>(N) << 2) + 13u);
    Word a = start, b = start, c = start;
    a += k[0];
    if constexpr (N > 1) b += k[1];
    if constexpr (N > 2) c += k[2];
    if constexpr (N > 3) {
        a -= c, a ^= rotl(c, 4), c += b;
        b -= a, b ^= rotl(a, 6), a += c;
        c -= b, c ^= rotl(b, 8), b += a;
        a -= c, a ^= rotl(c, 16), c += b;
        b -= a, b ^= rotl(a, 19), a += c;
        c -= b, c ^= rotl(b, 4), b += a;
        a += k[3];
    }
    c ^= b, c -= rotl(b, 14);
    a ^= c, a -= rotl(c, 11);
    b ^= a, b -= rotl(a, 25);
    c ^= b, c -= rotl(b, 16);
    a ^= c, a -= rotl(c, 4);
    b ^= a, b -= rotl(a, 14);
    c ^= b, c -= rotl(b, 24);
    return c;
}

/// Of the bits of floats.
template <class... Floats>
std::uint32_t hash_bits(Floats... x) {
    return hash_words(std::array<std::uint32_t, sizeof...(x)>{std::bit_cast<std::uint32_t>(x)...});
}

/// The same in [0, 1].
template <class... Floats>
float hash_floats(Floats... x) {
    return static_cast<float>(hash_bits(x...)) / static_cast<float>(0xffffffffu);
}

/// Three independent values, of a place of one to four coordinates.
template <std::size_t N>
Vec3f hash_color(const std::array<float, N>& k) {
    if constexpr (N == 4)
        return {hash_floats(k[0], k[1], k[2], k[3]), hash_floats(k[2], k[0], k[3], k[1]),
                hash_floats(k[3], k[2], k[1], k[0])};
    else
        return std::apply(
            [](auto... x) {
                return Vec3f(hash_floats(x...), hash_floats(x..., 1.0f), hash_floats(x..., 2.0f));
            },
            k);
}

}  // namespace granita
