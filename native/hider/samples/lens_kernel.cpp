// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/samples/lens_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/samples/lens_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kWide = 16;
using Tag = hn::CappedTag<float, kWide>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;

HWY_INLINE V set(float x) {
    return hn::Set(kTag, x);
}

// Concentric map (Shirley and Chiu 1997): the angle within a wedge is q = (b / a) pi / 4, |q| <= pi
// / 4, where sine and cosine are short polynomials (Taylor; the first term left out is below 4e-8).
HWY_INLINE void map(float* u, float* v) {
    const V zero = set(0.0f), one = set(1.0f), two = set(2.0f);
    const V x = two * hn::LoadU(kTag, u) - one, y = two * hn::LoadU(kTag, v) - one;
    const auto wide = hn::Gt(hn::Abs(x), hn::Abs(y));
    const V radius = hn::IfThenElse(wide, x, y), other = hn::IfThenElse(wide, y, x);
    const V q = hn::IfThenElseZero(hn::Ne(radius, zero), other / radius * set(0.78539816f));
    const V q2 = q * q;
    const V sine = q + q * q2 *
                           (set(-1.0f / 6) +
                            q2 * (set(1.0f / 120) + q2 * (set(-1.0f / 5040) + q2 / set(362880))));
    const V cosine =
        one + q2 * (set(-0.5f) + q2 * (set(1.0f / 24) + q2 * (set(-1.0f / 720) + q2 / set(40320))));
    hn::StoreU(radius * hn::IfThenElse(wide, cosine, sine), kTag, u);
    hn::StoreU(radius * hn::IfThenElse(wide, sine, cosine), kTag, v);
}

void map_all(float* u, float* v, std::size_t count) {
    std::size_t i = 0;
    const std::size_t lanes = hn::Lanes(kTag);
    for (; i + lanes <= count; i += lanes) map(u + i, v + i);
    if (i == count) return;
    float rest_u[kWide] = {}, rest_v[kWide] = {};
    std::copy(u + i, u + count, rest_u);
    std::copy(v + i, v + count, rest_v);
    map(rest_u, rest_v);
    std::copy_n(rest_u, count - i, u + i);
    std::copy_n(rest_v, count - i, v + i);
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(map_all);

void map_to_disc(float* u, float* v, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(map_all)(u, v, count);
}

}  // namespace granita
#endif
