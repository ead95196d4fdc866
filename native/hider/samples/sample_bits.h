// SPDX-License-Identifier: GPL-3.0-or-later
// The integer arithmetic of the sample table, compiled as C++ and as GLSL: plain functions of uint,
// so that every device makes the same bits (docs/architecture.md, decision 15).
//
//   seed  = block_seed(table_seed, pixel_x >> 7, pixel_y >> 7)       blocks of 128 pixels
//   place = morton(pixel_x & 127, pixel_y & 127) * samples + s
//   index = sequence_place(place, square_digits(samples))            sixteen a square
//   bits  = owen(sobol_reversed(index, d), dimension_seed(seed, d))  d: 0 x, 1 y, 2 t, 3 u, 4 v
//
// 32 fraction bits each; x and y keep the upper 20 (tile coordinates stay exact in a float), t, u,
// v the upper 24. Sobol with the direction numbers of Joe and Kuo 2008; (x, y) is a (0,2)-sequence.
// Nested uniform scrambling by hashing bit-reversed numbers: Laine and Karras 2011, Burley 2020,
// with the multipliers of Vegdahl 2021.  Z-order of pixels: Ahmed and Wonka 2020.
#ifndef GRANITA_SAMPLE_BITS_H
#define GRANITA_SAMPLE_BITS_H

#ifdef __cplusplus
#include <cstdint>
namespace granita::bits {
using uint = std::uint32_t;
#define GRANITA_BITS_FN inline
#else
#define GRANITA_BITS_FN
#endif

/// Direction numbers, bit-reversed, of dimensions 1 to 4, 32 each (dimension 0 is the index
/// itself).
#define GRANITA_SOBOL_REVERSED                                                                     \
    0x00000001u, 0x00000003u, 0x00000005u, 0x0000000fu, 0x00000011u, 0x00000033u, 0x00000055u,     \
        0x000000ffu, 0x00000101u, 0x00000303u, 0x00000505u, 0x00000f0fu, 0x00001111u, 0x00003333u, \
        0x00005555u, 0x0000ffffu, 0x00010001u, 0x00030003u, 0x00050005u, 0x000f000fu, 0x00110011u, \
        0x00330033u, 0x00550055u, 0x00ff00ffu, 0x01010101u, 0x03030303u, 0x05050505u, 0x0f0f0f0fu, \
        0x11111111u, 0x33333333u, 0x55555555u, 0xffffffffu, 0x00000001u, 0x00000003u, 0x00000006u, \
        0x00000009u, 0x00000017u, 0x0000003au, 0x00000071u, 0x000000a3u, 0x00000116u, 0x00000339u, \
        0x00000677u, 0x000009aau, 0x00001601u, 0x00003903u, 0x00007706u, 0x0000aa09u, 0x00010117u, \
        0x0003033au, 0x00060671u, 0x000909a3u, 0x00171616u, 0x003a3939u, 0x00717777u, 0x00a3aaaau, \
        0x01170001u, 0x033a0003u, 0x06710006u, 0x09a30009u, 0x16160017u, 0x3939003au, 0x77770071u, \
        0xaaaa00a3u, 0x00000001u, 0x00000003u, 0x00000004u, 0x0000000au, 0x0000001fu, 0x0000002eu, \
        0x00000045u, 0x000000c9u, 0x0000011bu, 0x000002a4u, 0x0000079au, 0x00000b67u, 0x0000101eu, \
        0x0000302du, 0x00004041u, 0x0000a0c3u, 0x0001f104u, 0x0002e28au, 0x000457dfu, 0x000c9baeu, \
        0x0011a105u, 0x002a7289u, 0x0079e7dbu, 0x00b6dba4u, 0x0100011au, 0x030002a7u, 0x0400079eu, \
        0x0a000b6du, 0x1f001001u, 0x2e003003u, 0x45004004u, 0xc900a00au, 0x00000001u, 0x00000002u, \
        0x00000004u, 0x0000000du, 0x0000001fu, 0x0000003bu, 0x0000005eu, 0x000000b9u, 0x0000015au, \
        0x000003f4u, 0x00000685u, 0x00000d0fu, 0x0000115bu, 0x000023f6u, 0x00004681u, 0x0000dd02u, \
        0x0001e144u, 0x000393cdu, 0x0005a6dfu, 0x000b4dbbu, 0x0014401eu, 0x003cd039u, 0x006df05au, \
        0x00dbb0b4u, 0x0101e145u, 0x020393cfu, 0x0405a6dbu, 0x0d0b4db6u, 0x1f144001u, 0x3b3cd002u, \
        0x5e6df004u, 0xb9dbb00du

#ifdef __cplusplus
inline constexpr uint kSobolReversed[128] = {GRANITA_SOBOL_REVERSED};
#else
const uint kSobolReversed[128] = uint[128](GRANITA_SOBOL_REVERSED);
#endif

/// Avalanche of 32 bits (lowbias32, Wellons 2018).
GRANITA_BITS_FN uint hash(uint x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

GRANITA_BITS_FN uint combine(uint a, uint b) {
    return hash(a ^ hash(b + 0x9e3779b9u));
}

GRANITA_BITS_FN uint block_seed(uint seed, uint block_x, uint block_y) {
    return combine(combine(hash(seed), block_x), block_y);
}

GRANITA_BITS_FN uint dimension_seed(uint seed, uint dimension) {
    return combine(seed, 0x10000u + dimension);
}

/// Bits of x (even places) and y interleaved; 16 bits each.
GRANITA_BITS_FN uint morton(uint x, uint y) {
    uint m = (x & 0xffffu) | (y << 16);
    m = (m & 0xff0000ffu) | ((m & 0x0000ff00u) << 8) | ((m >> 8) & 0x0000ff00u);
    m = (m & 0xf00ff00fu) | ((m & 0x00f000f0u) << 4) | ((m >> 4) & 0x00f000f0u);
    m = (m & 0xc3c3c3c3u) | ((m & 0x0c0c0c0cu) << 2) | ((m >> 2) & 0x0c0c0c0cu);
    m = (m & 0x99999999u) | ((m & 0x22222222u) << 1) | ((m >> 1) & 0x22222222u);
    return m;
}

GRANITA_BITS_FN uint reverse_bits(uint x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/// 4^m squares of a pixel that a table of 16 * 4^m samples a pixel goes through one by one, sixteen
/// samples in each; 0 for other numbers of samples.
GRANITA_BITS_FN uint square_digits(uint samples) {
    uint m = 0u;
    while (m < 4u && (16u << (2u * m)) < samples) ++m;
    return (16u << (2u * m)) == samples ? m : 0u;
}

/// Bits 0 to 3 of a place, each as the m bits of a place that change the first m digits of y alike:
/// [m][bit].
#define GRANITA_SQUARE_TWINS \
    0u, 0u, 0u, 0u, 1u, 1u, 1u, 1u, 1u, 2u, 1u, 2u, 1u, 2u, 4u, 7u, 1u, 2u, 4u, 8u
#ifdef __cplusplus
inline constexpr uint kSquareTwins[20] = {GRANITA_SQUARE_TWINS};
#else
const uint kSquareTwins[20] = uint[20](GRANITA_SQUARE_TWINS);
#endif

/// The place in the sequence of number i of the table, i's lowest 4 + 2 m bits permuted: sixteen in
/// a row have the same first m digits of x (the lowest bits of the place) and of y (a sum of all
/// bits: four lower bits count through the square, the uppermost m make up for them).  Linear over
/// exclusive or.
GRANITA_BITS_FN uint sequence_place(uint i, uint m) {
    const uint mask = (1u << m) - 1u, within = i & 15u;
    const uint x = (i >> 4) & mask;
    uint y = (i >> (4u + m)) & mask;
    for (uint bit = 0u; bit < 4u; ++bit)
        if (((within >> bit) & 1u) != 0u) y ^= kSquareTwins[4u * m + bit];
    const uint all = 4u + 2u * m;
    return ((i >> all) << all) | (y << (m + 4u)) | (within << m) | x;
}

/// Sobol point with its bits reversed: the first binary digit is the lowest bit.
GRANITA_BITS_FN uint sobol_reversed(uint index, uint dimension) {
    if (dimension == 0u) return index;
    uint x = 0u;
    for (uint i = (dimension - 1u) * 32u; index != 0u; index >>= 1, ++i)
        if ((index & 1u) != 0u) x ^= kSobolReversed[i];
    return x;
}

/// Owen scramble of a bit-reversed number; the result has its first binary digit on top.
GRANITA_BITS_FN uint owen(uint x, uint seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return reverse_bits(x);
}

/// REGULAR: centre of cell i of n on the unit interval, 20 fraction bits; n <= 2^17.
GRANITA_BITS_FN uint cell_center(uint i, uint n) {
    uint a = (2u * i + 1u) << 13;  // in two steps of 32 bits
    return (a / n << 6) + ((a % n) << 6) / n;
}

/// REGULAR, rotated: the row of the sample in column i of side^2 + 1, a Korobov lattice that is its
/// own mirror image about the pixel's centre; side <= 256.
GRANITA_BITS_FN uint rotated_row(uint i, uint side) {
    uint points = side * side + 1u;
    return (side * (side - 1u) / 2u + (points - side) % points * i) % points;
}

#ifdef __cplusplus
}  // namespace granita::bits
#endif
#undef GRANITA_BITS_FN
#endif
