// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/locate_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/locate_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<double>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;

HWY_INLINE V load(const float* values) {
    return hn::PromoteTo(kTag, hn::LoadU(hn::Rebind<float, Tag>(), values));
}

struct Corner {
    V x, y;
};

/// Products of floats are exact in double, so the difference has the right sign or is 0.
HWY_INLINE V edge(const Corner& a, const Corner& b) {
    return hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x));
}

HWY_INLINE hn::Mask<Tag> same_sign(const V& a, const V& b, const V& c) {
    const V zero = hn::Zero(kTag);
    return hn::Or(hn::And(hn::And(hn::Gt(a, zero), hn::Gt(b, zero)), hn::Gt(c, zero)),
                  hn::And(hn::And(hn::Lt(a, zero), hn::Lt(b, zero)), hn::Lt(c, zero)));
}

void locate(LocateLanes& lanes) {
    const V zero = hn::Zero(kTag), one = hn::Set(kTag, 1.0);
    for (int i = 0; i < LocateLanes::kCount; i += static_cast<int>(hn::Lanes(kTag))) {
        Corner d[4];
        for (int k = 0; k < 4; ++k) d[k] = {load(lanes.x[k] + i), load(lanes.y[k] + i)};
        const V e01 = edge(d[0], d[1]), e12 = edge(d[1], d[2]), e02 = edge(d[0], d[2]);
        const V e23 = edge(d[2], d[3]), e30 = edge(d[3], d[0]), e20 = hn::Neg(e02);
        const auto a = same_sign(e01, e12, e20), b = same_sign(e02, e23, e30);
        // A sample on a line that both triangles could share needs the exact test, and so does a
        // fold: both or none.
        const auto on_line =
            hn::Or(hn::Or(hn::Eq(e01, zero), hn::Eq(e12, zero)),
                   hn::Or(hn::Or(hn::Eq(e23, zero), hn::Eq(e30, zero)), hn::Eq(e02, zero)));
        const auto plain = hn::AndNot(on_line, hn::Xor(a, b));
        const V first = hn::IfThenElse(a, e12, e23), middle = hn::IfThenElse(a, e20, e30);
        const V last = hn::IfThenElse(a, e01, e02);
        const V sum = hn::Add(hn::Add(first, middle), last);
        hn::StoreU(hn::Div(middle, sum), kTag, lanes.b1 + i);
        hn::StoreU(hn::Div(last, sum), kTag, lanes.b2 + i);
        hn::StoreU(hn::IfThenElseZero(b, one), kTag, lanes.second + i);
        hn::StoreU(hn::IfThenElseZero(plain, one), kTag, lanes.plain + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(locate);

void locate_lanes(LocateLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(locate)(lanes);
}

}  // namespace granita
#endif
