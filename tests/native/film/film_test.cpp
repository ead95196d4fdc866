// SPDX-License-Identifier: GPL-3.0-or-later
// The film under synthetic samples: hard cases 1 to 3 and 5 to 9.
#include "film/film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <thread>

#include "measured.h"

namespace granita {
namespace {

using Shade = std::function<SampleColor(double x, double y)>;

SampleColor white(double alpha) {
    SampleColor c;
    c.color = Vec3f(static_cast<float>(alpha));
    c.alpha = static_cast<float>(alpha);
    return c;
}

struct Picture {
    Rect rect;
    std::vector<Vec4f> combined;
    std::vector<float> depth;
    const Vec4f& at(int x, int y) const {
        return combined[(y - rect.y0) * rect.width() + x - rect.x0];
    }
};

Options make_options(const Rect& crop, FilterKind kind, float width, int samples = 64) {
    Options options;
    options.width = crop.x1;
    options.height = crop.y1;
    options.crop = crop;
    options.pixel_filter = kind;
    options.filter_width = width;
    options.samples = samples;
    options.bucket_size = 32;
    return options;
}

std::vector<Vec2i> tiles_of(const Film& film) {
    const Rect p = film.sample_pixels();
    std::vector<Vec2i> tiles;
    for (int y = p.y0 >> 4; y <= (p.y1 - 1) >> 4; ++y)
        for (int x = p.x0 >> 4; x <= (p.x1 - 1) >> 4; ++x) tiles.push_back({x, y});
    return tiles;
}

TileContribution shade_tile(const Film& film, const SampleTable& table, Vec2i tile,
                            const Shade& shade) {
    TileSamples samples;
    table.fill_tile(tile, {}, samples);
    SampleColors colors(samples.x.size());
    for (std::size_t i = 0; i < samples.x.size(); ++i)
        colors.set(i, shade(tile.x * 16 + static_cast<double>(samples.x[i]),
                            tile.y * 16 + static_cast<double>(samples.y[i])));
    return film.filter_tile(tile, samples, colors);
}

void paste(const std::vector<Tile>& tiles, Picture& out, std::vector<int>* times = nullptr) {
    for (const Tile& tile : tiles)
        for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
            for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
                const std::size_t to = (y - out.rect.y0) * out.rect.width() + x - out.rect.x0;
                const std::size_t from = (y - tile.rect.y0) * tile.rect.width() + x - tile.rect.x0;
                out.combined[to] = tile.combined[from];
                if (!tile.depth.empty()) out.depth[to] = tile.depth[from];
                if (times) ++(*times)[to];
            }
}

/// `order`: seed of the tiles' order of arrival; 0 = raster order.
Picture expose(const Options& options, const Shade& shade, unsigned order = 0) {
    Film film(options);
    const SampleTable table(options, Camera());
    Picture out{options.crop, {}, {}};
    const std::size_t count = static_cast<std::size_t>(out.rect.width()) * out.rect.height();
    out.combined.assign(count, Vec4f(-99));
    out.depth.assign(count, -99);
    std::vector<int> times(count, 0);
    std::vector<Vec2i> tiles = tiles_of(film);
    if (order) std::shuffle(tiles.begin(), tiles.end(), std::mt19937(order));
    for (const Vec2i tile : tiles) {
        std::vector<TileContribution> one;
        one.push_back(shade_tile(film, table, tile, shade));
        paste(film.add(std::move(one)), out, &times);
    }
    for (const int n : times) EXPECT_EQ(n, 1);  // every pixel delivered once
    return out;
}

const std::pair<FilterKind, float> kFilters[] = {
    {FilterKind::Box, 1.0f},      {FilterKind::Tent, 2.0f},
    {FilterKind::Gaussian, 1.5f}, {FilterKind::BlackmanHarris, 1.5f},
    {FilterKind::Mitchell, 4.0f}, {FilterKind::CatmullRom, 4.0f},
    {FilterKind::Lanczos, 6.0f},  {FilterKind::Bspline, 4.0f}};

TEST(Film, EdgeResponse) {
    // A vertical edge at x = 20, samples on a 32 x 32 lattice: the sum over cells of width h = 1/32
    // is the integral to h^2 / 24 max |f'| (edges between lattice columns), below 2e-4.
    for (const auto& [kind, width] : kFilters)
        for (const double shift : {0.0, .25, .5}) {
            Options options = make_options({0, 0, 40, 1}, kind, width, 32 * 32);
            options.sampling = Sampling::Regular;
            Film film(options);
            const SampleTable table(options, Camera(), {false, false});
            Picture out{options.crop, std::vector<Vec4f>(40), std::vector<float>(40)};
            for (const Vec2i tile : tiles_of(film)) {
                std::vector<TileContribution> one;
                one.push_back(shade_tile(film, table, tile, [=](double x, double) {
                    return white(x < 20 + shift ? 1 : 0);
                }));
                paste(film.add(std::move(one)), out);
            }
            const PixelFilter filter(kind, width);
            for (int x = 0; x < 40; ++x) {
                const double expected = filter.edge_response(20 + shift - (x + .5));
                EXPECT_WITHIN(out.at(x, 0).w, expected, 2e-4)
                    << static_cast<int>(kind) << " x " << x << " shift " << shift;
                // Colour rings together with alpha, beyond 0 and 1, unclamped.
                EXPECT_EQ(out.at(x, 0).x, out.at(x, 0).w);
            }
        }
}

TEST(Film, SlantedEdge) {
    // y < x tan(th) through box 1: exact area by a fine midpoint rule; through the wide gaussian,
    // cut at 3.0 standard deviations, Phi to 2e-3.
    const double slope = std::tan(.3);
    const auto inside = [=](double x, double y) { return y < 2 + x * slope; };
    const Shade shade = [&](double x, double y) { return white(inside(x, y) ? 1 : 0); };
    const Picture box = expose(make_options({0, 0, 32, 16}, FilterKind::Box, 1), shade);
    const Picture gauss = expose(make_options({0, 0, 32, 16}, FilterKind::Gaussian, 4), shade);
    const double sigma = 4 / std::sqrt(16.0);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x) {
            double area = 0;
            for (int j = 0; j < 64; ++j)
                for (int i = 0; i < 64; ++i)
                    area += inside(x + (i + .5) / 64, y + (j + .5) / 64) / 4096.0;
            // Four times the errors of the worst pixels (docs/sampling_error.md); the midpoint
            // rule.
            EXPECT_WITHIN(box.at(x, y).w, area, 4 * .0209 + 1e-3);
            const double d = (2 + (x + .5) * slope - (y + .5)) * std::cos(.3);
            const double phi = .5 * std::erfc(-d / sigma / std::sqrt(2.0));
            // Far from the edge less: N_eff of a gaussian is 4 pi sigma^2 N samples; and the cut.
            const double far = 4 * std::sqrt(phi * (1 - phi) / (4 * M_PI * sigma * sigma * 64));
            EXPECT_WITHIN(gauss.at(x, y).w, phi, std::min(4 * .0041 + 2e-3, far + 3e-3));
        }
}

TEST(Film, ConstantStaysConstant) {
    // Also over tiles with different numbers of samples (hard case 7).
    for (const auto& [kind, width] : kFilters) {
        const Options options = make_options({3, 2, 51, 40}, kind, width, 16);
        Options dense = options;
        dense.samples = 64;
        const SampleTable sparse_table(options, Camera()), dense_table(dense, Camera());
        Film film(options);
        Picture out{options.crop, std::vector<Vec4f>(48 * 38), std::vector<float>(48 * 38)};
        SampleColor color;
        color.color = Vec3f(.3f, 7, 1);
        color.alpha = 1;
        for (const Vec2i tile : tiles_of(film)) {
            std::vector<TileContribution> one;
            one.push_back(shade_tile(film, (tile.x + tile.y) % 2 ? sparse_table : dense_table, tile,
                                     [&](double, double) { return color; }));
            paste(film.add(std::move(one)), out);
        }
        for (const Vec4f& c : out.combined) {
            EXPECT_WITHIN(c.x, .3f, 1e-6);  // rounding of sums
            EXPECT_WITHIN(c.y, 7, 2e-5);
            EXPECT_WITHIN(c.z, 1, 4e-6);
            EXPECT_WITHIN(c.w, 1, 4e-6);
        }
    }
}

TEST(Film, SeamBetweenSampleCountsDoesNotMoveAnEdge) {
    // An edge on the seam of tiles with 64 and 16 lattice samples: E(d), as without the seam.
    Options options = make_options({0, 0, 48, 32}, FilterKind::Mitchell, 4, 4096);
    options.sampling = Sampling::Regular;
    Options sparse = options;
    sparse.samples = 1024;
    const SampleTable dense_table(options, Camera(), {}), sparse_table(sparse, Camera(), {});
    Film film(options);
    Picture out{options.crop, std::vector<Vec4f>(48 * 32), std::vector<float>(48 * 32)};
    for (const Vec2i tile : tiles_of(film)) {
        std::vector<TileContribution> one;
        one.push_back(shade_tile(film, tile.x < 1 ? dense_table : sparse_table, tile,
                                 [](double x, double) { return white(x < 16 ? 1 : 0); }));
        paste(film.add(std::move(one)), out);
    }
    const PixelFilter filter(FilterKind::Mitchell, 4);
    for (int x = 8; x < 24; ++x)
        EXPECT_WITHIN(out.at(x, 16).w, filter.edge_response(16 - (x + .5)), 2e-4);
}

TEST(Film, FilterWiderThanTheBuckets) {
    // 32 pixels wide over buckets of 16 and tiles of 16: same bits as with buckets of 64, and the
    // sum of alpha is the area, since a B-spline is a partition of unity and all samples of the
    // square's 80 pixels are inside of it.  What is left is how far each pixel's weights sum to
    // other than 1: sixteen samples of a net have means within 1 / (16 sqrt(12 * 16)) = .0045
    // pixel, the filter's slope is at most 9e-4 a pixel, and 1024 pixels under it add up by their
    // root, of which half lies where the slope is small: 9e-5 of the sum.
    const Shade square = [](double x, double y) {
        return white(x >= 60 && x < 70 && y >= 58 && y < 66 ? 1 : 0);
    };
    Options options = make_options({0, 0, 128, 128}, FilterKind::Bspline, 32, 16);
    options.bucket_size = 16;
    const Picture small = expose(options, square, 3);
    options.bucket_size = 64;
    const Picture large = expose(options, square);
    double sum = 0;
    for (std::size_t i = 0; i < small.combined.size(); ++i) {
        EXPECT_EQ(small.combined[i], large.combined[i]);
        sum += small.combined[i].w;
    }
    EXPECT_WITHIN(sum, 80, 80 * 4 * 9e-5);
}

TEST(Film, SpillReachesEmptyBuckets) {
    // An object ends .3 pixels before a border of buckets of every size: the pixel beyond sees it.
    for (const int bucket : {16, 32, 64}) {
        Options options = make_options({0, 0, 128, 32}, FilterKind::Mitchell, 4, 256);
        options.bucket_size = bucket;
        const Picture p = expose(options, [](double x, double) { return white(x < 63.7 ? 1 : 0); });
        const PixelFilter filter(FilterKind::Mitchell, 4);
        // Errors of a column's mean (docs/sampling_error.md); single precision has 1e-6 of it.
        for (const auto& [x, error] :
             {std::pair{62, 4e-6}, {63, 2.1e-4}, {64, 5.3e-5}, {65, 2.6e-6}, {66, 0.0}}) {
            double column = 0;
            for (int y = 0; y < 32; ++y) column += p.at(x, y).w / 32;
            const double e = filter.edge_response(63.7 - (x + .5));
            EXPECT_WITHIN(column, e, 4 * error + 1e-6) << bucket << ' ' << x;
        }
    }
}

TEST(Film, ExtremeShapes) {
    const Shade grey = [](double, double) { return white(.5); };
    for (const Rect crop :
         {Rect{0, 0, 1, 1}, Rect{0, 0, 1, 50}, Rect{15, 15, 17, 17}, Rect{16000, 3, 16400, 4}}) {
        const Picture p = expose(make_options(crop, FilterKind::BlackmanHarris, 1.5f, 16), grey);
        for (const Vec4f& c : p.combined) EXPECT_WITHIN(c.w, .5, 1e-6);
    }
    Options empty = make_options({5, 5, 5, 9}, FilterKind::Box, 1);
    Film film(empty);
    EXPECT_TRUE(film.sample_pixels().empty());
    EXPECT_TRUE(film.add({}).empty());
}

TEST(Film, FilterNarrowerThanTheSamplesSpacingShowsTheNearest) {
    // One sample a pixel: each pixel is its own.  Four: of a lattice all are as near to the centre.
    const auto ramp = [](double x, double) { return white(x); };
    for (const auto& [kind, width] : kFilters) {
        Options options = make_options({0, 0, 8, 4}, kind, 0.01f, 1);
        options.sampling = Sampling::Independent;
        const SampleTable table(options, Camera());
        TileSamples samples;
        table.fill_tile({0, 0}, {}, samples);
        const Picture one = expose(options, ramp);
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 8; ++x) EXPECT_EQ(one.at(x, y).w, samples.x[y * kTileSize + x]);
        options.samples = 4;
        options.sampling = Sampling::Regular;
        const Picture four = expose(options, ramp);
        // Where the filter meets samples, sums of eighty round: a few units of the last place of 8.
        for (int x = 0; x < 8; ++x) EXPECT_WITHIN(four.at(x, 1).w, x + 0.5, 3e-6);
    }
}

TEST(Film, FarFromTheOriginLikeNearIt) {
    const auto edge = [](double at) {
        return [=](double x, double) { return white(x < at ? 1 : 0); };
    };
    Options near = make_options({0, 0, 32, 16}, FilterKind::BlackmanHarris, 1.5f, 64);
    Options far = make_options({16384, 0, 16416, 16}, FilterKind::BlackmanHarris, 1.5f, 64);
    near.sampling = far.sampling = Sampling::Regular;
    const Picture a = expose(near, edge(12.25)), b = expose(far, edge(16396.25));
    for (std::size_t i = 0; i < a.combined.size(); ++i) EXPECT_EQ(a.combined[i], b.combined[i]);
}

TEST(Film, ThinLinesKeepTheirEnergy) {
    // A line 1/20 pixel wide: alpha sums to its width a row, on average over the rows.
    const double w = .05;
    const Picture p =
        expose(make_options({0, 0, 32, 128}, FilterKind::Mitchell, 4, 64), [=](double x, double y) {
            const double at = 10 + y * .05;
            return white(x >= at && x < at + w ? 1 : 0);
        });
    double sum = 0;
    for (const Vec4f& c : p.combined) sum += c.w;
    EXPECT_WITHIN(sum / 128, w, 4 * .00123);  // docs/sampling_error.md
}

TEST(Film, CropOrderAndThreadsChangeNoBit) {
    const Shade pattern = [](double x, double y) {
        SampleColor c;
        c.color = {static_cast<float>(std::sin(x * 3) * y), static_cast<float>(std::cos(x * y)), 1};
        c.alpha = static_cast<float>(std::fabs(std::sin(x + y)));
        c.depth = static_cast<float>(x + 100 * y);
        return c;
    };
    Options options = make_options({0, 0, 100, 70}, FilterKind::Lanczos, 6, 9);
    options.depth_pass = true;
    const Picture whole = expose(options, pattern);
    const Picture shuffled = expose(options, pattern, 42);
    for (std::size_t i = 0; i < whole.combined.size(); ++i)
        ASSERT_EQ(whole.combined[i], shuffled.combined[i]);
    options.crop = {21, 33, 77, 50};
    options.bucket_size = 16;
    const Picture crop = expose(options, pattern, 7);
    for (int y = 33; y < 50; ++y)
        for (int x = 21; x < 77; ++x) {
            ASSERT_EQ(crop.at(x, y), whole.at(x, y)) << x << ' ' << y;
            ASSERT_EQ(crop.depth[(y - 33) * 56 + x - 21], whole.depth[y * 100 + x]);
        }

    options.crop = {0, 0, 100, 70};
    Film film(options);
    const SampleTable table(options, Camera());
    const std::vector<Vec2i> tiles = tiles_of(film);
    Picture threaded{options.crop, std::vector<Vec4f>(7000), std::vector<float>(7000)};
    std::mutex mutex;
    std::vector<std::thread> threads;
    for (std::size_t part = 0; part < 4; ++part)
        threads.emplace_back([&, part] {
            for (std::size_t i = part; i < tiles.size(); i += 4) {
                std::vector<TileContribution> one;
                one.push_back(shade_tile(film, table, tiles[i], pattern));
                const auto finished = film.add(std::move(one));
                const std::lock_guard lock(mutex);
                paste(finished, threaded);
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < whole.combined.size(); ++i)
        ASSERT_EQ(whole.combined[i], threaded.combined[i]);
}

TEST(Film, DepthIsThatOfTheCentralSample) {
    Options options = make_options({0, 0, 20, 20}, FilterKind::Mitchell, 4, 256);
    options.depth_pass = true;
    const Picture p = expose(options, [](double x, double y) {
        SampleColor c;
        c.depth = x < 10 ? static_cast<float>(1000 * y + x) : INFINITY;
        return c;
    });
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) {
            const float depth = p.depth[y * 20 + x];
            if (x >= 10) {
                EXPECT_EQ(depth, 1e10f);
            } else {
                // 256 stratified samples: one is within 1/8 pixel of the centre.
                EXPECT_WITHIN(depth, 1000 * (y + .5) + x + .5, 1000 * .125 + .125);
            }
        }
}

}  // namespace
}  // namespace granita
