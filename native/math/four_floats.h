// SPDX-License-Identifier: GPL-3.0-or-later
// Four numbers at once, by the compiler's vectors of 16 bytes, which every machine has: the same
// bits on all of them.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace granita {

using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));
using Words = std::uint32_t __attribute__((vector_size(16)));

inline Floats all(float x) {
    return Floats{x, x, x, x};
}

inline float sum(const Floats& x) {
    return (x[0] + x[1]) + (x[2] + x[3]);
}

inline Floats least(const Floats& a, const Floats& b) {
    return a < b ? a : b;
}

inline Floats most(const Floats& a, const Floats& b) {
    return a > b ? a : b;
}

inline Floats magnitude(const Floats& x) {
    return most(x, -x);
}

inline Floats root(const Floats& x) {
    return Floats{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

/// To the nearest whole number; |x| below 2^31.
inline Ints nearest(const Floats& x) {
    return __builtin_convertvector(x + (x < 0.0f ? all(-0.5f) : all(0.5f)), Ints);
}

/// e^x within 2e-7 of itself (Moshier's polynomial of Cephes); 0 below -87, from 88 on that of 88.
inline Floats exponential(const Floats& x) {
    const Floats from = least(most(x, all(-87.0f)), all(88.0f));
    const Ints n = nearest(from * 1.44269504f);
    const Floats whole = __builtin_convertvector(n, Floats);
    const Floats r = from - whole * 0.693359375f + whole * 2.12194440e-4f;  // less n ln 2
    Floats p = r * 1.9875691500e-4f + 1.3981999507e-3f;
    p = p * r + 8.3334519073e-3f;
    p = p * r + 4.1665795894e-2f;
    p = p * r + 1.6666665459e-1f;
    p = p * r + 5.0000001201e-1f;
    const Floats power = (p * r * r + r + 1.0f) * std::bit_cast<Floats>((n + 127) << 23);
    return x < -87.0f ? all(0.0f) : x == x ? power : x;
}

/// Within 2e-7 (Abramowitz and Stegun 4.4.46); -1 <= x <= 1.
inline Floats arc_sine(const Floats& x) {
    const Floats a = magnitude(x);
    Floats p = a * -0.0012624911f + 0.0066700901f;
    p = p * a - 0.0170881256f;
    p = p * a + 0.0308918810f;
    p = p * a - 0.0501743046f;
    p = p * a + 0.0889789874f;
    p = p * a - 0.2145988016f;
    p = p * a + 1.5707963050f;
    const Floats angle = 1.5707963268f - root(most(1.0f - a, all(0.0f))) * p;
    return x < 0.0f ? -angle : angle;
}

}  // namespace granita
