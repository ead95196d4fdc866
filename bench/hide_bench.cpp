// SPDX-License-Identifier: GPL-3.0-or-later
// Covered (sample, micropolygon) pairs a second on one core, one-pixel micropolygons, 64 samples:
// without motion, with 5, 20 and 100 pixels of motion, and with a circle of confusion of 5 pixels
// radius.  Beside them the stages that every sample pays for.
//
// GRANITA_VECTORS=256 measures what a machine without AVX-512 runs, 128 one without AVX2.
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "film/film.h"
#include "hider/hider.h"
#include "hider/resolve/composite.h"

namespace granita {
namespace {

[[maybe_unused]] const bool kNarrowed = [] {
    const char* const widest = std::getenv("GRANITA_VECTORS");
    if (!widest) return false;
    hwy::DisableTargets(HWY_AVX3 | HWY_AVX3_DL);
    if (std::string(widest) == "128") hwy::DisableTargets(HWY_AVX3 | HWY_AVX3_DL | HWY_AVX2);
    return true;
}();

Options bench_options() {
    Options options;
    options.crop = {0, 0, 64, 64};
    return options;
}

Camera pixel_camera() {
    Camera camera;
    camera.projection.perspective = false;
    camera.projection.far_clip = 1e6;
    return camera;
}

/// 16 x 16 micropolygons of one pixel, turned by 30 degrees, at depth z.
Grid make_grid(float x, float y, float z, float motion) {
    Grid grid;
    grid.n_u = grid.n_v = 16;
    grid.knots = motion > 0 ? 2 : 1;
    grid.motion = motion > 0;
    for (int k = 0; k < grid.knots; ++k)
        for (int j = 0; j <= 16; ++j)
            for (int i = 0; i <= 16; ++i) {
                const float u = static_cast<float>(i) - 8, v = static_cast<float>(j) - 8;
                const float shift = (static_cast<float>(k) - .5f) * motion;
                grid.positions.push_back({x + .8660254f * u - .5f * v + .8f * shift,
                                          y + .5f * u + .8660254f * v + .6f * shift, z});
            }
    grid.radiance.assign(grid.vertex_count(), Vec3f(1));
    const float reach = 16 + motion;
    grid.bounds = {x - reach, y - reach, x + reach, y + reach, -z, true};
    return grid;
}

/// Back to front, so that nothing is culled.
std::vector<Grid> make_layers(float motion) {
    std::vector<Grid> grids;
    for (int layer = 0; layer < 4; ++layer)
        for (int y = 8; y < 64; y += 14)
            for (int x = 8; x < 64; x += 14)
                grids.push_back(make_grid(static_cast<float>(x), static_cast<float>(y),
                                          20 - static_cast<float>(layer), motion));
    return grids;
}

/// `lens`: knots of (radius, focus distance).
void hide(benchmark::State& state, float motion, const std::vector<Vec2d>& lens) {
    Camera camera = pixel_camera();
    camera.lens = LensKnots(lens, camera.projection);
    const SampleTable table(bench_options(), camera);
    const std::vector<Grid> grids = make_layers(motion);
    Statistics statistics;
    const HiderFrame frame{&table, camera.projection, &statistics};
    std::uint64_t micropolygons = 0;
    for (auto _ : state) {
        state.PauseTiming();
        auto hider = make_simd_hider(frame, {0, 0, 4, 4}, {0, 0, 64, 64});
        state.ResumeTiming();
        for (const Grid& grid : grids) hider->hide(grid);
        benchmark::DoNotOptimize(hider->finish());
        micropolygons += grids.size() * 256;
    }
    const auto rate = [](std::uint64_t n) {
        return benchmark::Counter(static_cast<double>(n), benchmark::Counter::kIsRate);
    };
    const std::uint64_t tests =
        statistics.get(Counter::SampleTestsStatic) + statistics.get(Counter::SampleTestsMoving);
    state.counters["hits"] = rate(statistics.get(Counter::SampleHits));
    state.counters["tests"] = rate(tests);
    state.counters["micropolygons"] = rate(micropolygons);
    state.counters["tests_per_hit"] =
        static_cast<double>(tests) / static_cast<double>(statistics.get(Counter::SampleHits));
}
const std::vector<Vec2d> kPinhole{{0, 10}};
BENCHMARK_CAPTURE(hide, still, 0.0f, kPinhole);
BENCHMARK_CAPTURE(hide, motion_5px, 5.0f, kPinhole);
BENCHMARK_CAPTURE(hide, motion_20px, 20.0f, kPinhole);
BENCHMARK_CAPTURE(hide, motion_100px, 100.0f, kPinhole);
BENCHMARK_CAPTURE(hide, lens_5px, 0.0f, std::vector<Vec2d>{{5, 10}});
/// From 2 to 8 pixels.
BENCHMARK_CAPTURE(hide, lens_opens, 0.0f, std::vector<Vec2d>{{2, 10}, {8, 10}});
/// From 8 to 2 pixels.
BENCHMARK_CAPTURE(hide, lens_refocuses, 0.0f, std::vector<Vec2d>{{5, 7.7}, {5, 14.3}});
BENCHMARK_CAPTURE(hide, lens_refocuses_motion_20px, 20.0f, std::vector<Vec2d>{{5, 7.7}, {5, 14.3}});

void fill_table(benchmark::State& state, SampleNeeds needs, double last_focus, int count = 64) {
    Camera camera = pixel_camera();
    camera.lens = LensKnots({{1, 10}, {1, last_focus}}, camera.projection);
    Options options = bench_options();
    options.samples = count;
    const SampleTable table(options, camera);
    TileSamples samples;
    for (auto _ : state) {
        table.fill_tile({1, 2}, needs, samples);
        benchmark::DoNotOptimize(samples.x.data());
    }
    state.counters["samples"] = benchmark::Counter(
        static_cast<double>(state.iterations()) * 256 * count, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(fill_table, xy, SampleNeeds{false, false}, 10);
BENCHMARK_CAPTURE(fill_table, xyt, SampleNeeds{true, false}, 10);
BENCHMARK_CAPTURE(fill_table, xyt_8_samples, SampleNeeds{true, false}, 10, 8);
BENCHMARK_CAPTURE(fill_table, xytuv, SampleNeeds{true, true}, 10);
BENCHMARK_CAPTURE(fill_table, refocuses, SampleNeeds{true, true}, 20);

void composite(benchmark::State& state) {
    const Vec3f black(0.0f);
    const Camera camera = pixel_camera();
    const SampleTable table(bench_options(), camera);
    const std::vector<Grid> grids = make_layers(0);
    const HiderFrame frame{&table, camera.projection};
    const auto hider = make_simd_hider(frame, {1, 1, 2, 2}, {16, 16, 32, 32});
    for (const Grid& grid : grids) hider->hide(grid);
    auto& store = hider->finish()[0];
    const CompositeSettings settings{camera.projection, 1, true};
    SampleColors colors;
    LayerTable layers(hider->pool(), hider->seen_grids());
    for (auto _ : state) {
        composite_tile(store, hider->tile_samples(0), layers, {&black, 1}, settings, colors);
        benchmark::DoNotOptimize(colors.red.data());
    }
    state.counters["samples"] = benchmark::Counter(
        static_cast<double>(state.iterations()) * 256 * 64, benchmark::Counter::kIsRate);
}
BENCHMARK(composite);

void filter(benchmark::State& state) {
    Options options = bench_options();
    options.samples = static_cast<int>(state.range(0));
    const Film film(options);
    const SampleTable table(options, pixel_camera());
    TileSamples samples;
    table.fill_tile({1, 1}, {}, samples);
    const SampleColors colors(samples.x.size());
    for (auto _ : state) benchmark::DoNotOptimize(film.filter_tile({1, 1}, samples, colors));
    state.counters["samples"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * 256 * options.samples,
                           benchmark::Counter::kIsRate);
}
BENCHMARK(filter)->Arg(4)->Arg(8)->Arg(16)->Arg(64);

}  // namespace
}  // namespace granita
