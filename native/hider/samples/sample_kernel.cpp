// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/samples/sample_kernel.h"

#include <bit>
#include <cmath>

#include "hider/samples/sample_bits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/samples/sample_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<std::uint32_t, kSobolRun>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;

/// bits::reverse_bits
HWY_INLINE V reverse(V x) {
    const auto swap = [&](auto shift, std::uint32_t mask) HWY_ATTR {
        const V lower = hn::Set(kTag, mask);
        x = hn::Or(hn::And(hn::ShiftRight<shift()>(x), lower),
                   hn::ShiftLeft<shift()>(hn::And(x, lower)));
    };
    swap(std::integral_constant<int, 1>(), 0x55555555u);
    swap(std::integral_constant<int, 2>(), 0x33333333u);
    swap(std::integral_constant<int, 4>(), 0x0f0f0f0fu);
    swap(std::integral_constant<int, 8>(), 0x00ff00ffu);
    return hn::Or(hn::ShiftRight<16>(x), hn::ShiftLeft<16>(x));
}

/// bits::owen
HWY_INLINE V owen(V x, std::uint32_t seed) {
    const auto set = [](std::uint32_t k) HWY_ATTR { return hn::Set(kTag, k); };
    x = hn::Xor(x, x * set(0x3d20adeau));
    x = (x + set(seed)) * set((seed >> 16) | 1u);
    x = hn::Xor(x, x * set(0x05526c56u));
    x = hn::Xor(x, x * set(0x53a22864u));
    return reverse(x);
}

void fill(const SobolDimension& dimension, std::uint32_t seed, std::uint32_t first,
          std::size_t count, float* out) {
    const int digits = dimension.digits;
    const hn::RebindToSigned<Tag> as_int;
    const hn::RebindToFloat<Tag> as_float;
    const auto scale = hn::Set(as_float, std::ldexp(1.0f, -digits));
    std::uint32_t run = first / kSobolRun, base = dimension.point(first);
    for (std::size_t i = 0; i < count; i += kSobolRun) {
        for (std::size_t k = 0; k < kSobolRun; k += hn::Lanes(kTag)) {
            const V x = hn::Xor(hn::LoadU(kTag, dimension.within + k), hn::Set(kTag, base));
            const V upper = hn::ShiftRightSame(owen(x, seed), 32 - digits);
            const auto value = hn::ConvertTo(as_float, hn::BitCast(as_int, upper)) * scale;
            hn::StoreU(value, as_float, out + i + k);
        }
        base ^= dimension.toggle[std::countr_one(run++)];
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(fill);

SobolDimension::SobolDimension(int dimension, std::uint32_t digits_of_squares, int kept)
    : number(static_cast<std::uint32_t>(dimension)),
      square_digits(digits_of_squares),
      digits(kept) {
    for (std::uint32_t i = 0; i < kSobolRun; ++i) within[i] = point(i);
    constexpr int kLog = std::countr_zero(kSobolRun);
    std::uint32_t sum = 0;
    for (int i = 0; i + kLog < 32; ++i) toggle[i] = sum ^= point(1u << (i + kLog));
}

std::uint32_t SobolDimension::point(std::uint32_t i) const {
    return bits::sobol_reversed(bits::sequence_place(i, square_digits), number);
}

void fill_sobol(const SobolDimension& dimension, std::uint32_t seed, std::uint32_t first,
                std::size_t count, float* out) {
    HWY_DYNAMIC_DISPATCH(fill)(dimension, seed, first, count, out);
}

}  // namespace granita
#endif
