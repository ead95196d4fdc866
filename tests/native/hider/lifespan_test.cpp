// SPDX-License-Identifier: GPL-3.0-or-later
// What appears or vanishes within the shutter.
#include <algorithm>

#include "busy_scene.h"
#include "executor_test.h"

namespace granita::test {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

class Lifespans : public ExecutorTest {};
GRANITA_ALL_EXECUTORS(Lifespans);

/// A tile's samples of either sampling: a time of its own for each, or 16 passes.
struct TimedShot : Shot {
    explicit TimedShot(Sampling sampling = Sampling::Independent, int samples = 64) {
        options.sampling = sampling;
        options.samples = samples;
        options.time_samples = 16;
    }
};

Grid living(Grid grid, const Lifespan& lifespan) {
    grid.lifespan = lifespan;
    return grid;
}

TEST_P(Lifespans, StillSquareCoversItsShareOfTheShutter) {
    // Samples of a pixel have one time in each 64th of the shutter, passes one in each 16th: an end
    // of the interval is off by at most one of them.
    for (const auto& [sampling, strata] :
         {std::pair{Sampling::Independent, 64}, {Sampling::Regular, 16}})
        for (const Lifespan life : {Lifespan{0, .5f}, {.5f, kNever}, {.31f, .73f}, {.9f, .91f}}) {
            TimedShot shot(sampling);
            shot.grids.push_back(living(moving_rectangle(-2, -2, 18, 18, 5, 0, 0), life));
            const Picture p = render(GetParam(), shot);
            const double share = std::min(life.close, 1.0f) - life.open;
            const int ends = (life.open > 0) + (life.close < 1);
            double mean = 0;
            for (int y = 0; y < 16; ++y)
                for (int x = 0; x < 16; ++x) {
                    EXPECT_NEAR(p.alpha(x, y), share, 1e-6 + static_cast<double>(ends) / strata)
                        << life.open;
                    mean += p.alpha(x, y) / 256;
                }
            // Pixels of their own times: at each end one sample is there or not.
            if (sampling == Sampling::Independent) {
                EXPECT_WITHIN(mean, share, 4 * std::sqrt(ends * .25 / 256) / 64 + 1e-6);
            }
        }
}

TEST_P(Lifespans, HalvesOfTheShutterAreExact) {
    // Binary digits of times: both halves have as many samples.
    TimedShot shot;
    shot.grids.push_back(living(moving_rectangle(-2, -2, 18, 18, 5, 0, 0), {.25f, .75f}));
    const Picture p = render(GetParam(), shot);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) EXPECT_EQ(p.alpha(x, y), .5f);
}

TEST_P(Lifespans, MovingEdgeIsSeenWhileItExists) {
    // The edge is at 16 t: at x from t = x / 16 on.
    TimedShot shot;
    shot.grids.push_back(living(moving_rectangle(-100, -2, 0, 18, 5, 16, 0, 50, 10), {.2f, .7f}));
    const auto fraction = [](double x, double) { return std::max(0., .7 - std::max(.2, x / 16)); };
    EXPECT_LE(worst_excess(render(GetParam(), shot), fraction, {.0112, .0158}), 0);
}

TEST_P(Lifespans, OutAndBackFromTheMiddleOn) {
    // Two segments; the right border is at -10 + 40 (1 - 2 |t - 1/2|).
    TimedShot shot;
    const Grid way = make_grid(10, 5, 3, [](float u, float v, int k) {
        return Vec3f(-60 + 50 * u + (k == 1 ? 40.0f : 0.0f), -4 + 24 * v, 5);
    });
    shot.grids.push_back(living(way, {.5f, kNever}));
    const auto fraction = [](double x, double) {
        return std::clamp(1 - (x + 10) / 40, 0.0, 1.0) / 2;
    };
    EXPECT_LE(worst_excess(render(GetParam(), shot), fraction, {.0072, .0102}), 0);
}

/// Two grids of which one replaces the other against one that is always there, in front of
/// something else; bit by bit.
void expect_swap(HiderMaker make, Shot& shot, const Grid& grid, float time) {
    const auto picture = [&](const std::vector<Grid>& grids) {
        shot.grids = grids;
        shot.grids.push_back(rectangle(3, -2, 9, 18, 20));
        set_color(shot.grids.back(), Vec3f(.3f, .2f, .1f));
        return render(make, shot).combined;
    };
    Grid heir = grid;
    heir.key.instance += 1000;
    const auto whole = picture({grid});
    EXPECT_EQ(whole, picture({living(grid, {0, time}), living(heir, {time, kNever})})) << time;
    EXPECT_EQ(whole, picture({living(heir, {time, kNever}), living(grid, {0, time})})) << time;
}

TEST_P(Lifespans, SwapOfTwoIsOneBitByBit) {
    for (const Sampling sampling : {Sampling::Independent, Sampling::Regular})
        for (const float lens : {0.0f, 3.0f})
            for (const float opacity : {1.0f, .5f}) {
                TimedShot shot(sampling);
                shot.camera.projection.lens_radius = lens;
                shot.camera.projection.focus = 12;
                for (const float dx : {0.0f, 7.3f}) {
                    Grid grid = moving_rectangle(1.3f, 2.4f, 11.6f, 13.1f, 5, dx, .4f * dx, 7, 6);
                    set_color(grid, Vec3f(.9f, .5f, .2f), Vec3f(opacity));
                    expect_swap(GetParam(), shot, grid, .37f);
                }
            }
}

TEST_P(Lifespans, SwapAtTimesOfSamples) {
    // Half open: the sample at the very time belongs to the heir alone.
    TimedShot shot(Sampling::Independent, 16);
    TileSamples samples;
    SampleTable(shot.options, shot.camera).fill_tile({0, 0}, {true, false}, samples);
    const Grid grid = moving_rectangle(-2, -2, 18, 18, 5, 0, 0);
    for (const int i : {0, 77, 1234, 4095}) expect_swap(GetParam(), shot, grid, samples.t[i]);
}

TEST_P(Lifespans, TransparentHeirsMakeOneLayer) {
    TimedShot shot(Sampling::Independent, 16);
    for (const Lifespan life : {Lifespan{0, .2f}, {.2f, .6f}, {.6f, kNever}}) {
        shot.grids.push_back(living(moving_rectangle(-2, -2, 18, 18, 5, 0, 0), life));
        set_color(shot.grids.back(), Vec3f(1), Vec3f(.5f));
    }
    for (const int layers : layers_per_sample(GetParam(), shot)) EXPECT_EQ(layers, 1);
}

TEST_P(Lifespans, TheShuttersLastMomentBelongsToWhatOutlivesIt) {
    // A rolling shutter with rows of no duration gives whole rows one time: those of the top and
    // the bottom are the shutter's ends.
    TimedShot shot(Sampling::Independent, 16);
    shot.options.width = 16;
    shot.options.height = 16;
    shot.options.rolling_shutter = 0.0f;
    TileSamples samples;
    SampleTable(shot.options, shot.camera).fill_tile({0, 0}, {true, false}, samples);
    ASSERT_EQ(*std::max_element(samples.t.begin(), samples.t.end()), 1.0f);
    shot.grids.push_back(living(moving_rectangle(-2, -2, 18, 18, 5, 0, 0), {.5f, kNever}));
    const Picture p = render(GetParam(), shot);
    for (int y = 0; y < 16; ++y)
        EXPECT_EQ(p.alpha(3, y), samples.t[static_cast<std::size_t>(y) * 256] >= .5f ? 1.0f : 0.0f);
}

class LifespansAgree : public ExecutorTest {};
GRANITA_EXECUTORS(LifespansAgree, make_simd_hider, make_device_hider);

TEST_P(LifespansAgree, SampleBySampleWithTheReference) {
    for (const Blur blur : {kMoving, kBoth}) {
        Shot shot;
        make_busy(shot, blur);
        for (std::size_t g = 0; g < shot.grids.size(); ++g) {
            const float open = .1f * static_cast<float>(g);
            shot.grids[g].lifespan = {open, g % 3 ? open + .35f : kNever};
        }
        const Seen a = look(make_reference_hider, shot, shot.tiles);
        const Seen b = look(GetParam(), shot, shot.tiles);
        const Differences d = compare(shot, a, b);
        EXPECT_EQ(d.unexplained, 0);
        EXPECT_EQ(d.far_keys, 0);
        EXPECT_LT(d.other_surface + d.other_fragments, d.compared * 4.0 * 8 / 2048);
        for (std::size_t tile = 0; tile < b.stores.size(); ++tile)
            for (std::size_t i = 0; i < b.stores[tile].id.size(); ++i) {
                const SurfaceId id = b.stores[tile].id[i];
                if (id == kNoSurface) continue;
                const int per_grid = shot.grids[0].micropolygon_count();
                const Lifespan& life = shot.grids[id / static_cast<SurfaceId>(per_grid)].lifespan;
                EXPECT_TRUE(life.contains(b.samples[tile].t[i]));
            }
    }
}

TEST(Lifespan, SamplesOutsideOfItAreHardlyLookedAt) {
    // Strata of the SIMD executor are sorted by time where things move.
    const auto tests = [](const Lifespan& life) {
        TimedShot shot;
        shot.grids.push_back(living(moving_rectangle(-40, 2, 8, 14, 5, 32, 0, 48, 12), life));
        render(make_simd_hider, shot);
        return static_cast<double>(shot.statistics.get(Counter::SampleTestsMoving));
    };
    EXPECT_LT(tests({.25f, .5f}), .4 * tests({}));
}

}  // namespace
}  // namespace granita::test
