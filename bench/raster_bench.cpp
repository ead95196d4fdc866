// SPDX-License-Identifier: GPL-3.0-or-later
// The raster executor beside the CPU's, on the same bucket: four overlapping sheets of
// micropolygons of one pixel, static, 64 samples a pixel.  items = samples that a micropolygon
// covers.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <vector>

#include "hider/hider.h"
#include "hider/raster/raster_hider.h"

namespace granita {
namespace {

constexpr int kSide = 128, kLattice = 8, kGridSide = 16, kSheets = 4;

Projection bench_projection() {
    Projection p;
    p.scale = Vec2d(kSide / 2.0);
    p.center = Vec2d(kSide / 2.0);
    p.near_clip = 0.1;
    p.far_clip = 100.0;
    return p;
}

/// Micropolygons of one pixel over the bucket, a little tilted.
std::vector<Grid> bench_grids() {
    std::vector<Grid> grids;
    for (int sheet = 0; sheet < kSheets; ++sheet)
        for (int y = 0; y < kSide; y += kGridSide)
            for (int x = 0; x < kSide; x += kGridSide) {
                Grid grid;
                grid.key.instance = static_cast<std::uint32_t>(grids.size());
                grid.n_u = grid.n_v = kGridSide;
                for (int j = 0; j <= kGridSide; ++j)
                    for (int i = 0; i <= kGridSide; ++i) {
                        const float px = static_cast<float>(x + i), py = static_cast<float>(y + j);
                        const float z = 5.0f - 0.5f * static_cast<float>(sheet) + 0.01f * px;
                        grid.positions.emplace_back((px / (kSide / 2) - 1) * z,
                                                    (py / (kSide / 2) - 1) * z, z);
                        grid.radiance.emplace_back(0.5f);
                    }
                grid.bounds = {static_cast<float>(x),
                               static_cast<float>(y),
                               static_cast<float>(x + kGridSide),
                               static_cast<float>(y + kGridSide),
                               0.5f,
                               true};
                grids.push_back(std::move(grid));
            }
    return grids;
}

constexpr std::int64_t kHits = std::int64_t{kSheets} * kSide * kSide * kLattice * kLattice;

void raster(benchmark::State& state) {
    gl::GlThread thread;
    RasterFrame frame;
    frame.projection = bench_projection();
    frame.filter = make_raster_filter(kLattice, 1.5, [](double d) { return 1.5 - std::abs(d); });
    RasterHider hider(thread, frame);
    const std::vector<Grid> grids = bench_grids();
    std::vector<const Grid*> list;
    for (const Grid& grid : grids) list.push_back(&grid);
    for (auto _ : state) {
        auto bucket = hider.open({0, 0, kSide, kSide}, list);
        if (state.range(0) != 0) benchmark::DoNotOptimize(bucket->find_seen());
        benchmark::DoNotOptimize(bucket->render());
    }
    state.SetItemsProcessed(state.iterations() * kHits);
    state.SetLabel(thread.info().renderer);
}
BENCHMARK(raster)->ArgName("queries")->Arg(0)->Arg(1)->MeasureProcessCPUTime()->UseRealTime()->Unit(
    benchmark::kMillisecond);

void simd(benchmark::State& state) {
    Options options;
    options.sampling = Sampling::Regular;
    options.samples = kLattice * kLattice;
    Camera camera;
    camera.projection = bench_projection();
    const SampleTable table(options, camera, {});
    HiderFrame frame;
    frame.table = &table;
    frame.projection = camera.projection;
    const std::vector<Grid> grids = bench_grids();
    for (auto _ : state) {
        const auto hider = make_simd_hider(frame, {0, 0, kSide / kTileSize, kSide / kTileSize},
                                           {0, 0, kSide, kSide});
        for (const Grid& grid : grids) hider->hide(grid);
        benchmark::DoNotOptimize(hider->finish());
    }
    state.SetItemsProcessed(state.iterations() * kHits);
    state.SetLabel("without compositing and filter");
}
BENCHMARK(simd)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace granita
