// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/weigh_pixel.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "film/weigh_pixel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Colours are summed in so many lanes, on every target.
constexpr int kLanes = 8;
using Tag = hn::CappedTag<float, kLanes>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr hn::RebindToSigned<Tag> kIntTag;

struct V2 {
    V low, rise;
};

/// A step's value and its rise to the next are one 64-bit element: half the loads of two gathers.
HWY_INLINE V2 gather_pairs(const float* pairs, hn::Vec<decltype(kIntTag)> cell) {
    constexpr hn::RepartitionToWide<decltype(kIntTag)> wide;
    const auto* base = reinterpret_cast<const std::int64_t*>(pairs);
    const hn::Half<decltype(kIntTag)> half;
    const auto first = hn::GatherIndex(wide, base, hn::PromoteTo(wide, hn::LowerHalf(half, cell)));
    const auto second = hn::GatherIndex(wide, base, hn::PromoteTo(wide, hn::UpperHalf(half, cell)));
    const V low = hn::BitCast(kTag, first), high = hn::BitCast(kTag, second);
    return {hn::ConcatEven(kTag, high, low), hn::ConcatOdd(kTag, high, low)};
}

/// factors[i] = f(distance[i] - step) * scale
HWY_INLINE void factors(const FilterTable& f, const float* distance, float step, float scale,
                        int count, float* out) {
    const V offset = hn::Set(kTag, step), scales = hn::Set(kTag, scale), zero = hn::Zero(kTag);
    const V radius = hn::Set(kTag, f.radius), height = hn::Set(kTag, f.height);
    const V rate = hn::Set(kTag, f.steps_a_pixel);
    const V end = hn::Set(kTag, static_cast<float>(f.steps));
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    for (int i = 0; i < count; i += lanes) {
        const V d = hn::Sub(hn::LoadU(kTag, distance + i), offset);
        V value;
        if (f.is_box) {
            const auto inside = hn::And(hn::Ge(d, hn::Neg(radius)), hn::Lt(d, radius));
            value = hn::IfThenElseZero(inside, height);
        } else {
            const V place = hn::Min(hn::Mul(hn::Abs(d), rate), end);
            const auto cell = hn::ConvertTo(kIntTag, place);
            const V2 pairs = gather_pairs(f.pairs, cell);
            const V low = pairs.low, rise = pairs.rise;
            const V part = hn::Sub(place, hn::ConvertTo(kTag, cell));
            value = hn::Add(low, hn::Mul(part, rise));
            value = hn::IfThenElse(hn::Lt(place, end), value, zero);
        }
        hn::StoreU(hn::Mul(value, scales), kTag, out + i);
    }
}

HWY_INLINE WeightedSum weigh_colors(const PixelWork& work, const float* wx, const float* wy,
                                    float* weights) {
    constexpr int kStep = static_cast<int>(hn::MaxLanes(kTag));
    constexpr int kParts = kLanes / kStep;
    V r[kParts], g[kParts], b[kParts], a[kParts], w[kParts];
    for (int p = 0; p < kParts; ++p) r[p] = g[p] = b[p] = a[p] = w[p] = hn::Zero(kTag);
    for (int i = 0; i < work.padded; i += kLanes)
        for (int p = 0; p < kParts; ++p) {
            const int at = i + p * kStep;
            const V weight = hn::Mul(hn::LoadU(kTag, wx + at), hn::LoadU(kTag, wy + at));
            hn::StoreU(weight, kTag, weights + at);
            r[p] = hn::Add(r[p], hn::Mul(weight, hn::LoadU(kTag, work.red.data() + at)));
            g[p] = hn::Add(g[p], hn::Mul(weight, hn::LoadU(kTag, work.green.data() + at)));
            b[p] = hn::Add(b[p], hn::Mul(weight, hn::LoadU(kTag, work.blue.data() + at)));
            a[p] = hn::Add(a[p], hn::Mul(weight, hn::LoadU(kTag, work.alpha.data() + at)));
            w[p] = hn::Add(w[p], weight);
        }
    const auto sum = [](const V* parts) {
        float lanes[kLanes];
        for (int p = 0; p < kParts; ++p) hn::StoreU(parts[p], kTag, lanes + p * kStep);
        return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
               ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
    };
    return {sum(r), sum(g), sum(b), sum(a), sum(w)};
}

/// A vector of all samples' channels from `first` on, for kTaps pixels at once: each row is loaded
/// once for them.
template <int kTaps>
HWY_INLINE void weigh_channels(PixelWork& work, std::size_t first, int tap) {
    constexpr hn::ScalableTag<float> d;
    const auto padded = static_cast<std::size_t>(work.padded);
    const auto width = static_cast<std::size_t>(work.width);
    const float* weight = work.weights.data() + static_cast<std::size_t>(tap) * padded;
    const float* row = work.rows + first;
    hn::Vec<hn::ScalableTag<float>> sum[kTaps];
    for (int t = 0; t < kTaps; ++t) sum[t] = hn::Zero(d);
    for (int s = 0; s < work.samples; ++s, ++weight, row += width) {
        const auto value = hn::LoadU(d, row);
        for (int t = 0; t < kTaps; ++t)
            sum[t] = hn::Add(
                sum[t], hn::Mul(hn::Set(d, weight[static_cast<std::size_t>(t) * padded]), value));
    }
    float lanes[hn::MaxLanes(d)];
    const std::size_t count = std::min(hn::Lanes(d), width - first);
    float* out = work.row_sums.data() + static_cast<std::size_t>(tap) * width + first;
    for (int t = 0; t < kTaps; ++t, out += width) {
        hn::StoreU(sum[t], d, lanes);
        std::copy_n(lanes, count, out);
    }
}

void weigh(const FilterTable& filter, float share, PixelWork& work) {
    for (int tap = 0; tap < work.taps; ++tap) {
        const auto step = static_cast<float>(tap - work.each_side);
        const int row = tap * work.padded;
        factors(filter, work.x.data(), step, share, work.padded, work.weights_x.data() + row);
        factors(filter, work.y.data(), step, 1.0f, work.padded, work.weights_y.data() + row);
    }
    for (int y = 0; y < work.taps; ++y)
        for (int x = 0; x < work.taps; ++x)
            work.sums[y * work.taps + x] =
                weigh_colors(work, work.weights_x.data() + x * work.padded,
                             work.weights_y.data() + y * work.padded,
                             work.weights.data() + (y * work.taps + x) * work.padded);
    const std::size_t lanes = hn::Lanes(hn::ScalableTag<float>());
    const int taps = work.taps * work.taps;
    for (std::size_t first = 0; first < static_cast<std::size_t>(work.width); first += lanes) {
        int tap = 0;
        for (; tap + 9 <= taps; tap += 9) weigh_channels<9>(work, first, tap);
        for (; tap < taps; ++tap) weigh_channels<1>(work, first, tap);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(weigh);

PixelWork::PixelWork(int samples_a_pixel, int taps_each_side, int channel_width)
    : samples(samples_a_pixel),
      padded((samples_a_pixel + 7) / 8 * 8),
      each_side(taps_each_side),
      taps(2 * taps_each_side + 1),
      width(channel_width),
      x(padded, std::numeric_limits<float>::infinity()),
      y(x),
      red(padded),
      green(padded),
      blue(padded),
      alpha(padded),
      weights_x(taps * padded),
      weights_y(taps * padded),
      weights(taps * taps * padded),
      sums(taps * taps),
      row_sums(static_cast<std::size_t>(taps * taps) * width) {}

void weigh_pixel(const FilterTable& filter, float share, PixelWork& work) {
    HWY_DYNAMIC_DISPATCH(weigh)(filter, share, work);
}

}  // namespace granita
#endif
