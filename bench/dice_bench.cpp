// SPDX-License-Identifier: GPL-3.0-or-later
// Micropolygons split and diced a second, on one thread.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <vector>

#include "dice/open_instance.h"

namespace granita {
namespace {

/// A wavy sheet of n x n quads (or twice as many triangles) that fills the frame; `height` of its
/// waves over its width.
GeometryData sheet(int n, bool triangles, int knots, float height = 0.01f) {
    GeometryData data;
    data.name = "mesh 'Sheet'";
    data.knots = knots;
    for (int k = 0; k < knots; ++k)
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i)
                data.points.emplace_back(
                    2.0f * i / n - 1.0f, 2.0f * j / n - 1.0f,
                    2.0f * height * std::sin(9.0f * i / n + k) * std::cos(7.0f * j / n));
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int v = j * (n + 1) + i;
            if (triangles) {
                for (const int c : {v, v + 1, v + n + 2, v, v + n + 2, v + n + 1})
                    data.corner_verts.push_back(c);
                data.face_sizes.insert(data.face_sizes.end(), {3, 3});
            } else {
                for (const int c : {v, v + 1, v + n + 2, v + n + 1}) data.corner_verts.push_back(c);
                data.face_sizes.push_back(4);
            }
        }
    return data;
}

struct Frame {
    explicit Frame(GeometryData data) {
        scene.options.width = scene.options.height = 1024;
        scene.camera.world_from_camera = {Mat4d(1.0)};
        scene.geometries.push_back(std::move(data));
        Instance instance;
        Mat4d away(1.0);
        away[3][2] = 2.0;
        instance.world_from_object = {away};
        scene.instances.push_back(instance);
        view.scene = &scene;
        view.projection.scale = {1024.0, 1024.0};
        view.projection.center = {512.0, 512.0};
    }
    Scene scene;
    View view;
    Report report;
};

void dice_all(const Primitive& primitive, long& micropolygons, long& grids) {
    if (!primitive.bounds().visible) return;
    if (primitive.diceable()) {
        const auto grid = primitive.dice();
        if (grid->shading_state) grid->shading_state(*grid);
        micropolygons += grid->micropolygon_count();
        ++grids;
        return;
    }
    for (const auto& child : primitive.split()) dice_all(*child, micropolygons, grids);
}

void run(benchmark::State& state, GeometryData data) {
    Frame frame(std::move(data));
    long micropolygons = 0, grids = 0;
    for (auto _ : state) {
        const auto opened = open_instance(frame.view, 0, frame.report);
        for (std::size_t i = 0; i < opened->primitive_count(); ++i)
            dice_all(*opened->primitive(i), micropolygons, grids);
    }
    state.counters["micropolygons/s"] =
        benchmark::Counter(static_cast<double>(micropolygons), benchmark::Counter::kIsRate);
    state.counters["grids/s"] =
        benchmark::Counter(static_cast<double>(grids), benchmark::Counter::kIsRate);
    state.counters["micropolygons"] = static_cast<double>(micropolygons) / state.iterations();
}

/// Arguments: faces a side, knots.
void polygons(benchmark::State& state) {
    run(state, sheet(static_cast<int>(state.range(0)), false, static_cast<int>(state.range(1))));
}
/// Quads bent by more than a pair of triangles may be.
void bent_polygons(benchmark::State& state) {
    run(state,
        sheet(static_cast<int>(state.range(0)), false, static_cast<int>(state.range(1)), 0.1f));
}
void pixel_triangles(benchmark::State& state) {
    run(state, sheet(static_cast<int>(state.range(0)), true, static_cast<int>(state.range(1))));
}
void subdivision(benchmark::State& state) {
    GeometryData data =
        sheet(static_cast<int>(state.range(0)), false, static_cast<int>(state.range(1)));
    data.is_subdivision = true;
    run(state, std::move(data));
}
void irregular_subdivision(benchmark::State& state) {
    GeometryData data =
        sheet(static_cast<int>(state.range(0)), true, static_cast<int>(state.range(1)));
    data.is_subdivision = true;
    run(state, std::move(data));
}

BENCHMARK(polygons)
    ->Args({8, 1})
    ->Args({8, 3})
    ->Args({256, 1})
    ->Args({256, 3})
    ->Args({1024, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bent_polygons)->Args({8, 1})->Args({64, 1})->Unit(benchmark::kMillisecond);
BENCHMARK(pixel_triangles)->Args({512, 1})->Args({512, 3})->Unit(benchmark::kMillisecond);
BENCHMARK(subdivision)->Args({16, 1})->Args({16, 3})->Args({128, 1})->Unit(benchmark::kMillisecond);
BENCHMARK(irregular_subdivision)->Args({16, 1})->Args({16, 3})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace granita
