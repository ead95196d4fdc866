// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/filter_samples.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "film/filter_samples.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef GRANITA_FILM_WEIGH_TILE
#define GRANITA_FILM_WEIGH_TILE
namespace granita {

/// Samples of each pixel that are weighed at a time: their planes stay in the nearest cache, and
/// sums of few are added to the sums of all, which rounds less.
inline constexpr int kRun = 16;

/// Neighbouring pixels in a row that a sample is weighed for at once.  Each has sums of its own:
/// those of the next lie a float farther, and reading what has just been written across two
/// vectors waits for the cache.
inline constexpr int kTaps = 3;

/// A run of samples of each pixel of a row.
struct RowRun {
    enum { kX = TileSums::kPlanes - 1, kY, kPlanes };
    int samples;
    const float* factors_x;  ///< [taps][kRun][kTileSize]
    const float* factors_y;
    /// The colours by TileSums::Plane, then the place relative to the tile.
    alignas(64) float planes[kPlanes][kRun][kTileSize];
};

}  // namespace granita
#endif

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kTileSize>;
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

/// f(d)
HWY_INLINE V factor(const FilterPieces& f, V d) {
    if (f.is_box) {
        const V radius = hn::Set(kTag, f.radius);
        const auto inside = hn::And(hn::Ge(d, hn::Neg(radius)), hn::Lt(d, radius));
        return hn::IfThenElseZero(inside, hn::Set(kTag, f.height));
    }
    // Rounded to whole pieces by what leaves no digits behind the point: converting to integers and
    // back costs three operations more.
    const V whole = hn::Set(kTag, 0x1.8p23f);
    const V end = hn::Set(kTag, static_cast<float>(FilterPieces::kPieces));
    const V at = hn::Min(hn::Abs(d) * hn::Set(kTag, f.pieces_a_pixel) - hn::Set(kTag, 0.5f), end);
    const V rounded = at + whole;
    const IntV piece =
        hn::And(hn::BitCast(kIntTag, rounded), hn::Set(kIntTag, FilterPieces::kTable - 1));
    const V part = at - (rounded - whole);
    V value = look_up(f.coefficient[FilterPieces::kDegree], piece);
    for (int k = FilterPieces::kDegree - 1; k >= 0; --k)
        value = value * part + look_up(f.coefficient[k], piece);
    return value;
}

/// out[s][p] = from[p][s]: a row's samples beside each other, four by four of them at a time.
HWY_INLINE void turn(const float* from, int stride, int samples, float (*out)[kTileSize]) {
    constexpr hn::FixedTag<float, 4> d;
    constexpr hn::Repartition<double, decltype(d)> pairs;
    const int fours = samples & ~3;
    for (int p = 0; p < kTileSize; p += 4) {
        const float* at = from + p * stride;
        float* to = out[0] + p;
        for (int s = 0; s < fours; s += 4, at += 4, to += 4 * kTileSize) {
            const auto a = hn::LoadU(d, at), b = hn::LoadU(d, at + stride);
            const auto c = hn::LoadU(d, at + 2 * stride), e = hn::LoadU(d, at + 3 * stride);
            const auto ab = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
            const auto ce = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
            const auto upper_ab = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
            const auto upper_ce = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
            hn::Store(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)), d, to);
            hn::Store(hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce)), d, to + kTileSize);
            hn::Store(hn::BitCast(d, hn::InterleaveLower(pairs, upper_ab, upper_ce)), d,
                      to + 2 * kTileSize);
            hn::Store(hn::BitCast(d, hn::InterleaveUpper(pairs, upper_ab, upper_ce)), d,
                      to + 3 * kTileSize);
        }
    }
    for (int s = fours; s < samples; ++s)
        for (int p = 0; p < kTileSize; ++p) out[s][p] = from[p * stride + s];
}

/// The factors of a run for all taps, those of x times `share`.
HWY_INLINE void fill_factors(const FilterPieces& filter, float share, const RowRun& run, int taps,
                             float row_center, float* factors_x, float* factors_y) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    const V scale = hn::Set(kTag, share);
    const int middle = taps / 2;
    for (int tap = 0; tap < taps; ++tap) {
        const auto step = static_cast<float>(tap - middle);
        const V center_y = hn::Set(kTag, row_center + step);
        for (int p = 0; p < kTileSize; p += lanes) {
            const V center_x = hn::Iota(kTag, static_cast<float>(p) + 0.5f + step);
            float* to_x = factors_x + tap * kRun * kTileSize + p;
            float* to_y = factors_y + tap * kRun * kTileSize + p;
            for (int s = 0; s < run.samples; ++s, to_x += kTileSize, to_y += kTileSize) {
                const V x = hn::Load(kTag, run.planes[RowRun::kX][s] + p);
                const V y = hn::Load(kTag, run.planes[RowRun::kY][s] + p);
                hn::StoreU(factor(filter, x - center_x) * scale, kTag, to_x);
                hn::StoreU(factor(filter, y - center_y), kTag, to_y);
            }
        }
    }
}

/// The colours, weighed for kCount neighbours in a row at once: each is loaded once for them.
/// @param sums [kTaps][planes][plane_size], of those from the first pixel that they reach on.
template <int kCount>
HWY_INLINE void weigh_colors(const RowRun& run, const float* wx, const float* wy, float* sums,
                             std::size_t plane_size) {
    constexpr int kTap = kRun * kTileSize;
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    for (int p = 0; p < kTileSize; p += lanes) {
        V sum[kCount][TileSums::kPlanes];
        for (auto& tap : sum)
            for (V& plane : tap) plane = hn::Zero(kTag);
        for (int s = 0; s < run.samples; ++s) {
            const int at = s * kTileSize + p;
            const V across = hn::LoadU(kTag, wy + at);
            const V red = hn::Load(kTag, run.planes[TileSums::kRed][s] + p);
            const V green = hn::Load(kTag, run.planes[TileSums::kGreen][s] + p);
            const V blue = hn::Load(kTag, run.planes[TileSums::kBlue][s] + p);
            const V alpha = hn::Load(kTag, run.planes[TileSums::kAlpha][s] + p);
            for (int t = 0; t < kCount; ++t) {
                const V weight = hn::LoadU(kTag, wx + t * kTap + at) * across;
                sum[t][TileSums::kRed] = sum[t][TileSums::kRed] + weight * red;
                sum[t][TileSums::kGreen] = sum[t][TileSums::kGreen] + weight * green;
                sum[t][TileSums::kBlue] = sum[t][TileSums::kBlue] + weight * blue;
                sum[t][TileSums::kAlpha] = sum[t][TileSums::kAlpha] + weight * alpha;
                sum[t][TileSums::kWeight] = sum[t][TileSums::kWeight] + weight;
            }
        }
        for (int t = 0; t < kCount; ++t)
            for (int plane = 0; plane < TileSums::kPlanes; ++plane) {
                float* const to = sums + (t * TileSums::kPlanes + plane) * plane_size + p + t;
                hn::StoreU(hn::LoadU(kTag, to) + sum[t][plane], kTag, to);
            }
    }
}

/// A run of pixel `p`'s channels for kCount pixels at once: each row is loaded once for them.
/// @param rows of the run's first sample.
template <int kCount>
HWY_INLINE void weigh_channels(const RowRun& run, int taps, int first_tap, int p, int y,
                               const float* rows, TileSums& sums) {
    constexpr hn::ScalableTag<float> d;
    float weights[kCount][kRun];
    float* out[kCount];
    for (int t = 0; t < kCount; ++t) {
        const int tap_x = (first_tap + t) % taps, tap_y = (first_tap + t) / taps;
        const std::size_t pixel = static_cast<std::size_t>(y + tap_y) * sums.side + p + tap_x;
        out[t] = sums.rows.data() + pixel * sums.width;
        for (int s = 0; s < run.samples; ++s)
            weights[t][s] = run.factors_x[(tap_x * kRun + s) * kTileSize + p] *
                            run.factors_y[(tap_y * kRun + s) * kTileSize + p];
    }
    for (std::size_t first = 0; first < sums.width; first += hn::Lanes(d)) {
        hn::Vec<decltype(d)> sum[kCount];
        for (auto& tap : sum) tap = hn::Zero(d);
        const float* row = rows + first;
        for (int s = 0; s < run.samples; ++s, row += sums.width) {
            const auto value = hn::LoadU(d, row);
            for (int t = 0; t < kCount; ++t)
                sum[t] = hn::Add(sum[t], hn::Mul(hn::Set(d, weights[t][s]), value));
        }
        const auto inside = hn::FirstN(d, sums.width - first);
        for (int t = 0; t < kCount; ++t)
            hn::BlendedStore(hn::Add(hn::LoadU(d, out[t] + first), sum[t]), inside, d,
                             out[t] + first);
    }
}

/// @param rows of the row's first sample at hand.
HWY_INLINE void weigh_rows(const RowRun& run, int samples, int taps, int y, const float* rows,
                           TileSums& sums) {
    for (int p = 0; p < kTileSize; ++p, rows += static_cast<std::size_t>(samples) * sums.width) {
        int tap = 0;
        for (; tap + 9 <= taps * taps; tap += 9)
            weigh_channels<9>(run, taps, tap, p, y, rows, sums);
        for (; tap < taps * taps; ++tap) weigh_channels<1>(run, taps, tap, p, y, rows, sums);
    }
}

void weigh(const FilterPieces& filter, const TileSamples& samples, const SampleColors& colors,
           const float* channels, int y0, int y1, TileSums& sums) {
    const int n = samples.samples, taps = 2 * sums.each_side + 1;
    const float share = 1.0f / static_cast<float>(n);
    const std::vector<float>* const planes[] = {&colors.red,   &colors.green, &colors.blue,
                                                &colors.alpha, &samples.x,    &samples.y};
    std::vector<float> factors(static_cast<std::size_t>(2 * taps * kRun) * kTileSize);
    std::vector<float> color_sums(kTaps * sums.planes.size(), 0.0f);
    float* const factors_x = factors.data();
    float* const factors_y = factors_x + taps * kRun * kTileSize;
    RowRun run;
    run.factors_x = factors_x;
    run.factors_y = factors_y;
    const auto weigh_run = [&](auto count, int tap_x, int tap_y, int y) HWY_ATTR {
        weigh_colors<count()>(run, factors_x + tap_x * kRun * kTileSize,
                              factors_y + tap_y * kRun * kTileSize,
                              color_sums.data() + (y + tap_y) * sums.side + tap_x, sums.pixels());
    };
    for (int y = y0; y < y1; ++y)
        for (int first = 0; first < n; first += kRun) {
            const std::size_t at = static_cast<std::size_t>(y * kTileSize) * n + first;
            run.samples = std::min(kRun, n - first);
            for (int k = 0; k < RowRun::kPlanes; ++k)
                turn(planes[k]->data() + at, n, run.samples, run.planes[k]);
            fill_factors(filter, share, run, taps, static_cast<float>(y) + 0.5f, factors_x,
                         factors_y);
            for (int tap_y = 0; tap_y < taps; ++tap_y) {
                int tap_x = 0;
                for (; tap_x + kTaps <= taps; tap_x += kTaps)
                    weigh_run(std::integral_constant<int, kTaps>(), tap_x, tap_y, y);
                for (; tap_x < taps; ++tap_x)
                    weigh_run(std::integral_constant<int, 1>(), tap_x, tap_y, y);
            }
            if (sums.width > 0) weigh_rows(run, n, taps, y, channels + at * sums.width, sums);
        }
    const float* const one = color_sums.data();
    const std::size_t count = sums.planes.size();
    for (std::size_t i = 0; i < count; ++i)
        sums.planes[i] += (one[i] + one[count + i]) + one[2 * count + i];
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(weigh);

void filter_samples(const FilterPieces& filter, const TileSamples& samples,
                    const SampleColors& colors, const float* channels, int y0, int y1,
                    TileSums& sums) {
    HWY_DYNAMIC_DISPATCH(weigh)(filter, samples, colors, channels, y0, y1, sums);
}

}  // namespace granita
#endif
