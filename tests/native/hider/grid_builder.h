// SPDX-License-Identifier: GPL-3.0-or-later
// Grids by hand, and the shortest way from grids to pixels: hide, composite, average a pixel's
// samples (a box filter of one pixel).
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "hider/hider.h"
#include "hider/resolve/composite.h"
#include "measured.h"

namespace granita::test {

/// Orthographic, one unit = one pixel, camera z = depth.
inline Camera pixel_camera() {
    Camera camera;
    camera.projection.perspective = false;
    camera.projection.near_clip = 0.01;
    camera.projection.far_clip = 1e6;
    return camera;
}

/// f pixels focal length, optical axis at pixel (0, 0).
inline Camera pinhole_camera(double f) {
    Camera camera;
    camera.projection.scale = {f, f};
    camera.projection.near_clip = 0.1;
    camera.projection.far_clip = 1e6;
    return camera;
}

/// The fragments of a tile's samples, nearest first.
inline std::vector<std::vector<Fragment>> lists_of(const TileStore& store) {
    std::vector<std::vector<Fragment>> lists(store.key.size());
    for (std::uint32_t slot = 0; slot < store.lists.slots(); ++slot)
        for (std::uint32_t k = 0; k < store.lists.counts()[slot]; ++k)
            lists[store.lists.sample(slot)].push_back(store.lists.at(slot, k));
    return lists;
}

using Surface = std::function<Vec3f(float u, float v, int knot)>;

/// White and opaque; seen from anywhere (infinite bounds).
inline Grid make_grid(int n_u, int n_v, int knots, const Surface& surface) {
    static std::uint32_t serial = 0;
    Grid grid;
    grid.key.instance = serial++;
    grid.n_u = n_u;
    grid.n_v = n_v;
    grid.knots = knots;
    grid.motion = knots > 1;
    for (int k = 0; k < knots; ++k)
        for (int j = 0; j <= n_v; ++j)
            for (int i = 0; i <= n_u; ++i)
                grid.positions.push_back(surface(static_cast<float>(i) / static_cast<float>(n_u),
                                                 static_cast<float>(j) / static_cast<float>(n_v),
                                                 k));
    const float inf = std::numeric_limits<float>::infinity();
    grid.bounds = {-inf, -inf, inf, inf, inf, true};
    grid.radiance.assign(grid.vertex_count(), Vec3f(1.0f));
    return grid;
}

/// The rectangle [x0, x1] x [y0, y1] at depth z.
inline Grid rectangle(float x0, float y0, float x1, float y1, float z, int n_u = 4, int n_v = 4) {
    return make_grid(n_u, n_v, 1, [=](float u, float v, int) {
        return Vec3f(x0 + u * (x1 - x0), y0 + v * (y1 - y0), z);
    });
}

/// Moving by (dx, dy) over the shutter.
inline Grid moving_rectangle(float x0, float y0, float x1, float y1, float z, float dx, float dy,
                             int n_u = 4, int n_v = 4) {
    return make_grid(n_u, n_v, 2, [=](float u, float v, int k) {
        const auto t = static_cast<float>(k);
        return Vec3f(x0 + u * (x1 - x0) + t * dx, y0 + v * (y1 - y0) + t * dy, z);
    });
}

/// Radius r about (cx, cy), as a polar grid; `radius` may depend on the knot.
inline Grid disc(float cx, float cy, const std::vector<float>& radius, const std::vector<float>& z,
                 int sides = 256, int rings = 8) {
    return make_grid(sides, rings, static_cast<int>(radius.size()), [=](float u, float v, int k) {
        const int side = static_cast<int>(std::lround(u * static_cast<float>(sides))) % sides;
        const double angle = 2.0 * 3.14159265358979323846 * side / sides;
        // Outer radius such that the polygon has the disc's area.
        const double step = 3.14159265358979323846 / sides;
        const double r = radius[k] * v * std::sqrt(step / (std::sin(step) * std::cos(step)));
        return Vec3f(cx + r * std::cos(angle), cy + r * std::sin(angle), z[k]);
    });
}

inline void set_color(Grid& grid, const Vec3f& color, const Vec3f& opacity = Vec3f(1.0f)) {
    grid.radiance.assign(grid.vertex_count(), color * opacity);
    grid.opacity_varies = opacity != Vec3f(1.0f);
    grid.opacity.assign(grid.opacity_varies ? grid.vertex_count() : 0, opacity);
}

using Vec4d = glm::dvec4;
using HiderMaker = std::unique_ptr<Hider> (*)(const HiderFrame&, const Rect&, const Rect&);

struct Shot {
    Options options;
    Camera camera = pixel_camera();
    std::vector<Grid> grids;
    CompositeSettings composite;
    Vec3f background{0.0f};
    Rect tiles{0, 0, 1, 1};  ///< of 16 pixels
    Statistics statistics;

    Shot() { composite.film_transparent = true; }
};

struct Picture {
    Rect pixels;
    std::vector<Vec4f> combined;  ///< colour and alpha, mean of the pixel's samples
    const Vec4f& at(int x, int y) const {
        return combined[(y - pixels.y0) * pixels.width() + x - pixels.x0];
    }
    float alpha(int x, int y) const { return at(x, y).w; }
};

/// Stands for the raster executor where pictures or layers are asked for (raster_executor.h).
std::unique_ptr<Hider> raster_executor(const HiderFrame&, const Rect&, const Rect&);
Picture raster_picture(Shot& shot);
std::vector<int> raster_layers(Shot& shot);

/// One bucket of all tiles.
inline Picture render(HiderMaker make, Shot& shot) {
    if (make == raster_executor) return raster_picture(shot);
    const SampleTable table(shot.options, shot.camera);
    const Rect& tiles = shot.tiles;
    Picture out;
    out.pixels = {tiles.x0 * 16, tiles.y0 * 16, tiles.x1 * 16, tiles.y1 * 16};
    out.combined.assign(static_cast<std::size_t>(out.pixels.width()) * out.pixels.height(),
                        Vec4f(0.0f));
    HiderFrame frame{&table, shot.camera.projection, &shot.statistics};
    frame.list_end = shot.composite.end;
    frame.z_batch_size = shot.options.z_batch_size;
    shot.composite.projection = shot.camera.projection;
    const auto hider = make(frame, tiles, out.pixels);
    for (const Grid& grid : shot.grids)
        if (!hider->occluded(grid.bounds)) hider->hide(grid);
    auto& stores = hider->finish();
    for (std::size_t i = 0; i < stores.size(); ++i) {
        const int n = hider->tile_samples(i).samples;
        SampleColors colors;
        LayerTable table(hider->pool(), hider->seen_grids());
        composite_tile(stores[i], hider->tile_samples(i), table, std::span(&shot.background, 1),
                       shot.composite, colors);
        for (int p = 0; p < 256; ++p) {
            const int x = stores[i].tile.x * 16 + p % 16, y = stores[i].tile.y * 16 + p / 16;
            Vec4d sum(0.0);
            for (int s = 0; s < n; ++s)
                sum += Vec4d(Vec3d(colors[p * n + s].color), colors[p * n + s].alpha);
            out.combined[(y - out.pixels.y0) * out.pixels.width() + x - out.pixels.x0] =
                Vec4f(sum / static_cast<double>(n));
        }
    }
    return out;
}

/// Mean of a closed form of points over the pixel, by the midpoint rule.
inline double pixel_mean(const std::function<double(double, double)>& f, int x, int y) {
    constexpr int kSide = 24;
    double sum = 0.0;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) sum += f(x + (i + 0.5) / kSide, y + (j + 0.5) / kSide);
    return sum / (kSide * kSide);
}

/// What sampling leaves of a picture (docs/sampling_error.md, "The tests' own pictures"): standard
/// errors of a pixel that is covered in part, over all of them and of the worst.
struct SamplingError {
    double rms, worst;
};

/// Largest violation, over the pixels that are covered in part, of: each within four times the
/// error of the worst; their RMS within 1.3 times what is predicted, as sampling_error.md allows;
/// their mean within four times the error of a mean of as many.  Negative when all hold.
inline double worst_excess(const Picture& picture, const std::function<double(double, double)>& f,
                           const SamplingError& predicted) {
    // Closed forms are averaged over a pixel by the midpoint rule.
    constexpr double kMidpoint = 1e-3;
    double worst = -1.0, sum = 0.0, squares = 0.0;
    int partial = 0;
    for (int y = picture.pixels.y0; y < picture.pixels.y1; ++y)
        for (int x = picture.pixels.x0; x < picture.pixels.x1; ++x) {
            const double expected = pixel_mean(f, x, y), error = picture.alpha(x, y) - expected;
            const double limit = 4.0 * predicted.worst + kMidpoint;
            note_held(std::fabs(error), limit);
            worst = std::fmax(worst, std::fabs(error) - limit);
            if (expected <= 0.0 || expected >= 1.0) continue;
            sum += error;
            squares += error * error;
            ++partial;
        }
    const double mean_limit = 4.0 * predicted.rms / std::sqrt(partial) + kMidpoint;
    const double rms_limit = 1.3 * predicted.rms + kMidpoint;
    return std::fmax(worst, std::fmax(std::fabs(sum) / partial - mean_limit,
                                      std::sqrt(squares / partial) - rms_limit));
}

/// How many transparent layers, of opacity 1/2, each sample of the bucket has met.
inline std::vector<int> layers_per_sample(HiderMaker make, Shot& shot) {
    if (make == raster_executor) return raster_layers(shot);
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection, &shot.statistics};
    const Rect& tiles = shot.tiles;
    const auto hider =
        make(frame, tiles, {tiles.x0 * 16, tiles.y0 * 16, tiles.x1 * 16, tiles.y1 * 16});
    for (const Grid& grid : shot.grids) hider->hide(grid);
    std::vector<int> layers;
    for (const TileStore& store : hider->finish()) {
        for (const auto& list : lists_of(store)) layers.push_back(static_cast<int>(list.size()));
    }
    return layers;
}

}  // namespace granita::test

#include "hider/raster/raster_executor.h"
