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

constexpr int kLanes = PixelWork::kLanes;
using Tag = hn::CappedTag<float, kLanes>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr hn::RebindToSigned<Tag> kIntTag;
using IntV = hn::Vec<decltype(kIntTag)>;

/// values[piece] in every lane; piece < FilterPieces::kTable.
HWY_INLINE V look_up(const float* values, IntV piece) {
    if constexpr (hn::MaxLanes(kTag) == 16) {
        return hn::TableLookupLanes(hn::LoadU(kTag, values), hn::IndicesFromVec(kTag, piece));
    } else if constexpr (hn::MaxLanes(kTag) == 8) {
        const auto index = hn::IndicesFromVec(kTag, hn::And(piece, hn::Set(kIntTag, 7)));
        const auto upper = hn::RebindMask(kTag, hn::Gt(piece, hn::Set(kIntTag, 7)));
        return hn::IfThenElse(upper, hn::TableLookupLanes(hn::LoadU(kTag, values + 8), index),
                              hn::TableLookupLanes(hn::LoadU(kTag, values), index));
    } else {
        return hn::GatherIndex(kTag, values, piece);
    }
}

/// factors[i] = f(place[i] - center) * scale
HWY_INLINE void factors(const FilterPieces& f, const float* place, float center, float scale,
                        int count, float* out) {
    const V middle = hn::Set(kTag, center), scales = hn::Set(kTag, scale);
    const V radius = hn::Set(kTag, f.radius), height = hn::Set(kTag, f.height);
    const V rate = hn::Set(kTag, f.pieces_a_pixel);
    const V end = hn::Set(kTag, static_cast<float>(FilterPieces::kPieces));
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    for (int i = 0; i < count; i += lanes) {
        const V d = hn::LoadU(kTag, place + i) - middle;
        V value;
        if (f.is_box) {
            const auto inside = hn::And(hn::Ge(d, hn::Neg(radius)), hn::Lt(d, radius));
            value = hn::IfThenElseZero(inside, height);
        } else {
            const V at = hn::Min(hn::Abs(d) * rate, end);
            const IntV piece = hn::ConvertTo(kIntTag, at);
            const V part = at - hn::ConvertTo(kTag, piece);
            value = look_up(f.coefficient[FilterPieces::kDegree], piece);
            for (int k = FilterPieces::kDegree - 1; k >= 0; --k)
                value = value * part + look_up(f.coefficient[k], piece);
        }
        hn::StoreU(value * scales, kTag, out + i);
    }
}

/// The colours, weighed for kTaps neighbours in a row at once: each is loaded once for them.
template <int kTaps>
HWY_INLINE void weigh_colors(const PixelWork& work, const float* wx, const float* wy,
                             float* weights, WeightedSum* sums) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    const std::size_t padded = static_cast<std::size_t>(work.padded);
    alignas(64) float r[kTaps][kLanes], g[kTaps][kLanes], b[kTaps][kLanes], a[kTaps][kLanes],
        w[kTaps][kLanes];
    for (int part = 0; part < kLanes; part += lanes) {
        V sum_r[kTaps], sum_g[kTaps], sum_b[kTaps], sum_a[kTaps], sum_w[kTaps];
        for (int t = 0; t < kTaps; ++t)
            sum_r[t] = sum_g[t] = sum_b[t] = sum_a[t] = sum_w[t] = hn::Zero(kTag);
        for (int i = part; i < work.padded; i += kLanes) {
            const V across = hn::LoadU(kTag, wy + i);
            const V red = hn::LoadU(kTag, work.red + i), green = hn::LoadU(kTag, work.green + i);
            const V blue = hn::LoadU(kTag, work.blue + i), alpha = hn::LoadU(kTag, work.alpha + i);
            for (int t = 0; t < kTaps; ++t) {
                const V weight = hn::LoadU(kTag, wx + t * padded + i) * across;
                if (weights) hn::StoreU(weight, kTag, weights + t * padded + i);
                sum_r[t] = sum_r[t] + weight * red;
                sum_g[t] = sum_g[t] + weight * green;
                sum_b[t] = sum_b[t] + weight * blue;
                sum_a[t] = sum_a[t] + weight * alpha;
                sum_w[t] = sum_w[t] + weight;
            }
        }
        for (int t = 0; t < kTaps; ++t) {
            hn::StoreU(sum_r[t], kTag, r[t] + part);
            hn::StoreU(sum_g[t], kTag, g[t] + part);
            hn::StoreU(sum_b[t], kTag, b[t] + part);
            hn::StoreU(sum_a[t], kTag, a[t] + part);
            hn::StoreU(sum_w[t], kTag, w[t] + part);
        }
    }
    const auto total = [](const float* x) HWY_ATTR {
        constexpr hn::FixedTag<float, 4> d;
        alignas(16) float s[4];
        hn::Store(
            (hn::Load(d, x) + hn::Load(d, x + 4)) + (hn::Load(d, x + 8) + hn::Load(d, x + 12)), d,
            s);
        return (s[0] + s[1]) + (s[2] + s[3]);
    };
    for (int t = 0; t < kTaps; ++t)
        sums[t] = {total(r[t]), total(g[t]), total(b[t]), total(a[t]), total(w[t])};
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

void weigh(const FilterPieces& filter, float share, PixelWork& work) {
    for (int tap = 0; tap < work.taps; ++tap) {
        const auto step = static_cast<float>(tap - work.each_side);
        const int row = tap * work.padded;
        factors(filter, work.x, work.center.x + step, share, work.padded,
                work.weights_x.data() + row);
        factors(filter, work.y, work.center.y + step, 1.0f, work.padded,
                work.weights_y.data() + row);
    }
    const auto weigh_row = [&](auto taps, int x, int y) HWY_ATTR {
        const int tap = y * work.taps + x;
        weigh_colors<taps()>(work, work.weights_x.data() + x * work.padded,
                             work.weights_y.data() + y * work.padded,
                             work.width > 0 ? work.weights.data() + tap * work.padded : nullptr,
                             work.sums.data() + tap);
    };
    for (int y = 0; y < work.taps; ++y) {
        int x = 0;
        for (; x + 3 <= work.taps; x += 3) weigh_row(std::integral_constant<int, 3>(), x, y);
        for (; x < work.taps; ++x) weigh_row(std::integral_constant<int, 1>(), x, y);
    }
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
      padded((samples_a_pixel + kLanes - 1) / kLanes * kLanes),
      each_side(taps_each_side),
      taps(2 * taps_each_side + 1),
      width(channel_width),
      weights_x(taps * padded),
      weights_y(taps * padded),
      weights(width > 0 ? taps * taps * padded : 0),
      sums(taps * taps),
      row_sums(static_cast<std::size_t>(taps * taps) * width) {
    if (padded == samples) return;
    for (int i = 0; i < 6; ++i)
        m_copies[i].assign(padded, i < 2 ? std::numeric_limits<float>::infinity() : 0.0f);
}

void PixelWork::load(const TileSamples& tile, const SampleColors& colors, std::size_t first,
                     Vec2f pixel_center, const float* channel_rows) {
    center = pixel_center;
    rows = channel_rows;
    const std::vector<float>* const from[] = {&tile.x,       &tile.y,      &colors.red,
                                              &colors.green, &colors.blue, &colors.alpha};
    const float** const to[] = {&x, &y, &red, &green, &blue, &alpha};
    for (int i = 0; i < 6; ++i) {
        *to[i] = from[i]->data() + first;
        if (padded == samples) continue;
        std::copy_n(*to[i], samples, m_copies[i].begin());
        *to[i] = m_copies[i].data();
    }
}

void weigh_pixel(const FilterPieces& filter, float share, PixelWork& work) {
    HWY_DYNAMIC_DISPATCH(weigh)(filter, share, work);
}

}  // namespace granita
#endif
