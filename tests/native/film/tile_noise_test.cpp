// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/tile_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "scene/scene.h"

namespace granita {
namespace {

constexpr int kPixels = kTileSize * kTileSize;

TileSamples table(int count) {
    Options options;
    options.samples = count;
    TileSamples samples;
    SampleTable(options, Camera()).fill_tile({3, 5}, {}, samples);
    return samples;
}

/// Grey and opaque: `value` of a sample's index and place.
SampleColors shade(const TileSamples& samples,
                   const std::function<float(std::size_t, float, float)>& value) {
    SampleColors colors(static_cast<std::size_t>(kPixels) * samples.samples);
    for (std::size_t i = 0; i < colors.size(); ++i)
        colors.set(i, {Vec3f(value(i, samples.x[i], samples.y[i])), 1.0f, 0.0f});
    return colors;
}

// Three of the four planes that are averaged are noisy.
const float kColors = std::sqrt(3.0f / 4.0f);

TEST(TileNoise, IsNoneOfWhatIsConstant) {
    for (const int count : {2, 7, 16, 64}) {
        const TileSamples samples = table(count);
        EXPECT_LT(tile_noise(samples, shade(samples, [](auto...) { return 0.3f; })), 1e-6f);
    }
}

TEST(TileNoise, IsTheStandardErrorOfIndependentValues) {
    // Displayed, a small change d of .25 is one of d; the worst of four quarters, of 64 pixels and
    // three channels that are alike, is at most 4 deviations (1 / sqrt(2 * 64) each) larger.
    constexpr float kDeviation = 0.01f;
    for (const int count : {4, 7, 16, 64, 256}) {
        const TileSamples samples = table(count);
        std::mt19937 random(7);
        std::normal_distribution<float> values(0.25f, kDeviation);
        const float noise =
            tile_noise(samples, shade(samples, [&](auto...) { return values(random); }));
        const float expected = kColors * kDeviation / std::sqrt(static_cast<float>(count));
        EXPECT_GT(noise, expected * (1.0f - 4.0f / std::sqrt(128.0f))) << count;
        EXPECT_LT(noise, expected * (1.0f + 4.0f / std::sqrt(128.0f))) << count;
    }
}

TEST(TileNoise, ASlopeAcrossPixelsIsLittle) {
    // Halves are nets themselves: each is right to a part of a stratum's width, not of the pixel's.
    for (const int count : {16, 64, 256}) {
        const TileSamples samples = table(count);
        const SampleColors slope =
            shade(samples, [](std::size_t, float x, float y) { return 0.2f + 0.01f * (x + y); });
        const float independent = 0.01f * std::sqrt(2.0f / 12.0f / static_cast<float>(count));
        EXPECT_LT(tile_noise(samples, slope), 0.6f * independent) << count;
    }
}

TEST(TileNoise, OneQuarterIsEnough) {
    const TileSamples samples = table(16);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> values(0.2f, 0.3f);
    const SampleColors all = shade(samples, [&](auto...) { return values(random); });
    const SampleColors corner = shade(samples, [&](std::size_t, float x, float y) {
        return x >= 8.0f && y < 8.0f ? values(random) : 0.25f;
    });
    EXPECT_GT(tile_noise(samples, corner), 0.7f * tile_noise(samples, all));
}

TEST(TileNoise, OpacityCounts) {
    const TileSamples samples = table(16);
    SampleColors colors(static_cast<std::size_t>(kPixels) * 16);
    std::mt19937 random(3);
    for (std::size_t i = 0; i < colors.size(); ++i)
        colors.set(i, {Vec3f(0.0f), random() % 2 ? 1.0f : 0.0f, 0.0f});
    EXPECT_GT(tile_noise(samples, colors), 0.02f);
}

TEST(TileNoise, OneSampleSaysNothing) {
    const TileSamples samples = table(1);
    EXPECT_TRUE(std::isinf(tile_noise(samples, shade(samples, [](auto...) { return 0.3f; }))));
}

}  // namespace
}  // namespace granita
