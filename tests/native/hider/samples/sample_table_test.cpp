// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/samples/sample_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "hider/samples/sample_bits.h"

namespace granita {
namespace {

Options make_options(int samples, Sampling sampling) {
    Options options;
    options.samples = samples;
    options.sampling = sampling;
    options.seed = 17;
    return options;
}

Camera lens_camera() {
    Camera camera;
    camera.projection.lens_radius = 0.1;
    return camera;
}

TileSamples fill(const Options& options, Vec2i tile = {3, 5},
                 const Camera& camera = lens_camera()) {
    TileSamples out;
    SampleTable(options, camera).fill_tile(tile, {true, true}, out);
    return out;
}

float fraction(float x) {
    return x - std::floor(x);
}

/// Every box of 2^-a x 2^-b with a + b = m holds the same number of the points.
void expect_net(const std::vector<float>& x, const std::vector<float>& y, int m, int expected) {
    for (int a = 0; a <= m; ++a) {
        std::map<std::pair<int, int>, int> boxes;
        for (std::size_t i = 0; i < x.size(); ++i)
            ++boxes[{static_cast<int>(std::ldexp(x[i], a)),
                     static_cast<int>(std::ldexp(y[i], m - a))}];
        ASSERT_EQ(boxes.size(), std::size_t{1} << m) << "a = " << a;
        for (const auto& [box, count] : boxes) ASSERT_EQ(count, expected) << "a = " << a;
    }
}

TEST(SampleBits, SobolMatchesPublishedPoints) {
    // Points 1 to 3 of dimensions 1 and 2 (Joe and Kuo).
    const double expected[3][2] = {{0.5, 0.5}, {0.25, 0.75}, {0.75, 0.25}};
    for (std::uint32_t i = 1; i <= 3; ++i)
        for (std::uint32_t d = 0; d < 2; ++d) {
            const double x = bits::reverse_bits(bits::sobol_reversed(i, d)) / 4294967296.0;
            EXPECT_EQ(x, expected[i - 1][d]);
        }
    // The second dimension is Pascal's matrix modulo 2 applied to the index (Lucas' theorem).
    for (std::uint32_t index = 0; index < 64; ++index) {
        std::uint32_t expected_bits = 0;
        for (int row = 0; row < 6; ++row)
            for (int column = row; column < 6; ++column)
                if ((row & (column - row)) == 0 && (index >> column & 1))
                    expected_bits ^= 1u << row;
        EXPECT_EQ(bits::sobol_reversed(index, 1), expected_bits);
    }
}

TEST(SampleBits, MortonInterleaves) {
    EXPECT_EQ(bits::morton(0x7f, 0), 0x1555u);
    EXPECT_EQ(bits::morton(0, 0x7f), 0x2aaau);
    EXPECT_EQ(bits::morton(5, 3), 0x1bu);
}

TEST(SampleTable, PixelsAreNets) {
    const int n = 64;
    const TileSamples s = fill(make_options(n, Sampling::Independent));
    for (const int p : {0, 17, 255}) {
        std::vector<float> x, y, t;
        for (int i = p * n; i < (p + 1) * n; ++i) {
            EXPECT_EQ(std::floor(s.x[i]), static_cast<float>(p % 16));
            EXPECT_EQ(std::floor(s.y[i]), static_cast<float>(p / 16));
            x.push_back(fraction(s.x[i]));
            y.push_back(fraction(s.y[i]));
            t.push_back(s.t[i]);
        }
        expect_net(x, y, 6, 1);
        // Sobol's third dimension: a (1, m, 3)-net, so pairs with t have at most quality 1.
        expect_net(x, t, 5, 2);
        expect_net(y, t, 5, 2);
        std::sort(t.begin(), t.end());
        for (int i = 0; i < n; ++i) EXPECT_EQ(std::floor(t[i] * n), i);
    }
}

TEST(SampleTable, NeighbouringPixelsShareANet) {
    const int n = 16;
    const TileSamples s = fill(make_options(n, Sampling::Independent));
    std::vector<float> x, y;
    for (const int p : {0, 1, 16, 17})
        for (int i = p * n; i < (p + 1) * n; ++i) {
            x.push_back(fraction(s.x[i]));
            y.push_back(fraction(s.y[i]));
        }
    expect_net(x, y, 6, 1);
}

TEST(SampleTable, SixteenInARowShareASquare) {
    for (const int n : {16, 64, 256, 1024, 4096})
        for (const Sampling kind : {Sampling::Independent, Sampling::Interleaved}) {
            const TileSamples s = fill(make_options(n, kind));
            const int side = 1 << s.square_digits;
            ASSERT_EQ(16 * side * side, n);
            const auto square = [&](std::size_t i) {
                return std::pair(static_cast<int>(s.x[i] * static_cast<float>(side)),
                                 static_cast<int>(s.y[i] * static_cast<float>(side)));
            };
            for (std::size_t i = 0; i < s.x.size(); ++i) ASSERT_EQ(square(i), square(i & ~15ul));
        }
    EXPECT_EQ(fill(make_options(48, Sampling::Independent)).square_digits, 0);
    EXPECT_EQ(fill(make_options(64, Sampling::Regular)).square_digits, 0);
}

TEST(SampleTable, SquaresKeepThePixelsSequence) {
    for (std::uint32_t m = 0; m <= 4; ++m) {
        const std::uint32_t n = 16u << 2 * m;
        EXPECT_EQ(bits::square_digits(n), m);
        std::vector<bool> met(n, false);
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t place = bits::sequence_place(3 * n + i, m);
            ASSERT_EQ(place / n, 3u);
            met[place % n] = true;
        }
        EXPECT_EQ(std::count(met.begin(), met.end(), true), n);
    }
    EXPECT_EQ(bits::square_digits(128), 0u);
    EXPECT_EQ(bits::square_digits(16384), 0u);
}

TEST(SampleTable, SameBitsWhateverIsAskedFor) {
    for (const Sampling kind : {Sampling::Independent, Sampling::Interleaved}) {
        const SampleTable table(make_options(24, kind), lens_camera());
        TileSamples all, still;
        table.fill_tile({-7, 2}, {true, true}, all);
        table.fill_tile({-7, 2}, {false, false}, still);
        EXPECT_EQ(all.x, still.x);
        EXPECT_EQ(all.y, still.y);
        EXPECT_TRUE(still.t.empty() && still.u.empty() && still.v.empty());
        TileSamples again;
        table.fill_tile({-7, 2}, {true, false}, again);
        EXPECT_EQ(all.t, again.t);
    }
}

TEST(SampleTable, ARollingShutterSpreadsItsRowsOverTheTime) {
    // Row y of n: (u - 1/2) d + (1/2 - y / n) (1 - d) + 1/2; beyond the frame as its last row.
    Options options = make_options(8, Sampling::Independent);
    options.height = 40;
    const TileSamples plain = fill(options, {0, 2});
    options.rolling_shutter = 0.25f;
    const TileSamples rolled = fill(options, {0, 2});
    EXPECT_EQ(rolled.x, plain.x);
    for (int p = 0; p < 256; ++p) {
        const double row = std::min(32 + p / 16, 39);
        for (int i = p * 8; i < (p + 1) * 8; ++i)
            ASSERT_NEAR(rolled.t[i], (plain.t[i] - 0.5) * 0.25 + (0.5 - row / 40) * 0.75 + 0.5,
                        1e-6);
    }
}

TEST(SampleTable, StaysInsideItsRanges) {
    for (const Sampling kind : {Sampling::Independent, Sampling::Interleaved, Sampling::Regular})
        for (const Vec2i tile : {Vec2i{0, 0}, Vec2i{-1, -9}, Vec2i{1100, 700}}) {
            const TileSamples s = fill(make_options(25, kind), tile);
            ASSERT_EQ(s.x.size(), 256u * s.samples);
            for (std::size_t i = 0; i < s.x.size(); ++i) {
                const int p = static_cast<int>(i) / s.samples;
                ASSERT_EQ(std::floor(s.x[i]), static_cast<float>(p % 16));
                ASSERT_EQ(std::floor(s.y[i]), static_cast<float>(p / 16));
                ASSERT_TRUE(s.t[i] >= 0.0f && s.t[i] < 1.0f);
                ASSERT_LE(s.u[i] * s.u[i] + s.v[i] * s.v[i], 1.0f + 1e-6f);
            }
        }
}

TEST(SampleTable, SeedsAndBlocksDiffer) {
    Options options = make_options(16, Sampling::Independent);
    const TileSamples a = fill(options, {0, 0}), b = fill(options, {8, 0});
    options.seed = 18;
    const TileSamples c = fill(options, {0, 0});
    int same_block = 0, same_seed = 0;
    for (std::size_t i = 0; i < a.x.size(); ++i) {
        same_block += a.x[i] == b.x[i];
        same_seed += a.x[i] == c.x[i];
    }
    EXPECT_LT(same_block, 10);
    EXPECT_LT(same_seed, 10);
}

TEST(SampleTable, InterleavedRepeatsItsClasses) {
    const int n = 16;  // 1024 classes at most: squares of 8 pixels
    const TileSamples s = fill(make_options(n, Sampling::Interleaved));
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int i = 0; i < n; ++i) {
                const std::size_t at = (y * 16 + x) * n + i;
                for (const std::size_t there : {at + 8 * n, at + 8 * 16 * n}) {
                    ASSERT_EQ(s.t[at], s.t[there]);
                    ASSERT_EQ(s.u[at], s.u[there]);
                    ASSERT_EQ(s.v[at], s.v[there]);
                    ASSERT_NE(fraction(s.x[at]), fraction(s.x[there]));
                }
            }
    std::vector<float> times;  // the classes together: a stratified set of 1024 times
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int i = 0; i < n; ++i) times.push_back(s.t[(y * 16 + x) * n + i]);
    std::sort(times.begin(), times.end());
    for (std::size_t i = 0; i < times.size(); ++i)
        ASSERT_EQ(std::floor(times[i] * static_cast<float>(times.size())), static_cast<float>(i));
}

TEST(SampleTable, RegularIsALatticeInEveryPass) {
    Options options = make_options(15, Sampling::Regular);  // nearest square: 16
    options.time_samples = 5;
    const SampleTable table(options, lens_camera());
    ASSERT_EQ(table.lattice().cells(), 17);
    ASSERT_EQ(table.samples(), 85);
    TileSamples s;
    table.fill_tile({0, 0}, {true, true}, s);
    for (int p = 0; p < 256; ++p)
        for (int i = 0; i < 85; ++i) {
            const int at = p * 85 + i, cell = i % 17, pass = i / 17;
            EXPECT_EQ(s.x[at], static_cast<float>(p % 16) + s.x[cell]);
            EXPECT_EQ(s.y[at], static_cast<float>(p / 16) + s.y[cell]);
            EXPECT_NEAR(s.t[at], (pass + .5) / 5, 1e-6);
            EXPECT_EQ(s.u[at], s.u[pass * 17]);
        }
}

TEST(SampleTable, RegularWithOnePassIsSquare) {
    Options options = make_options(15, Sampling::Regular);
    options.time_samples = 5;
    const SampleTable table(options, Camera(), {false, true});
    ASSERT_EQ(table.samples(), 16);
    EXPECT_EQ(SampleTable(options, lens_camera(), {false, false}).samples(), 16);
    TileSamples s;
    table.fill_tile({0, 0}, {false, false}, s);
    for (int p = 0; p < 256; ++p)
        for (int i = 0; i < 16; ++i) {
            EXPECT_EQ(s.x[p * 16 + i],
                      static_cast<float>(p % 16) + (static_cast<float>(i % 4) + .5f) / 4);
            EXPECT_EQ(s.y[p * 16 + i],
                      static_cast<float>(p / 16) + (static_cast<float>(i / 4) + .5f) / 4);
        }
}

TEST(SampleTable, RotatedLatticesShareNoColumnAndNoRow) {
    for (const int side : {2, 3, 4, 5, 8, 15, 32, 256}) {
        const RegularLattice lattice(side, true);
        const int n = side * side + 1;
        ASSERT_EQ(lattice.cells(), n);
        std::set<std::pair<int, int>> texels;
        std::vector<int> row_of(n, -1);
        for (int cell = 0; cell < n; ++cell) {
            const Vec2f place = lattice.place(cell);
            EXPECT_NEAR(place.x, (cell + .5) / n, 0x1p-20);
            const int row = static_cast<int>(place.y * static_cast<float>(n));
            EXPECT_NEAR(place.y, (row + .5) / n, 0x1p-20);
            row_of[static_cast<std::size_t>(cell)] = row;
            // Texels are squares turned by atan(1 / side), a sample at the centre of each.
            const Vec2i texel = lattice.texel(cell);
            texels.insert({texel.x, texel.y});
            const double half = side % 2 == 1 ? 0.5 : 0.0;
            EXPECT_NEAR(side * place.x + place.y, texel.x + .5, 1e-3) << side;
            EXPECT_NEAR(side * place.y - place.x + half, texel.y + .5, 1e-3) << side;
        }
        EXPECT_EQ(texels.size(), static_cast<std::size_t>(n));
        for (int cell = 0; cell < n; ++cell)  // its own mirror image about the pixel's centre
            EXPECT_EQ(row_of[cell] + row_of[n - 1 - cell], n - 1);
        std::sort(row_of.begin(), row_of.end());
        for (int row = 0; row < n; ++row) EXPECT_EQ(row_of[row], row);
    }
}

TEST(SampleTable, RotatedTexelsAreAlignedWithWholePixels) {
    const RegularLattice lattice(3, true);
    EXPECT_EQ(lattice.first_texel({2, 5}), Vec2i(3 * 2 + 5, 3 * 5 - 2));
    const Rect texels = lattice.texels_of({2, 5, 4, 9});
    for (int y = 5; y < 9; ++y)
        for (int x = 2; x < 4; ++x)
            for (int cell = 0; cell < lattice.cells(); ++cell) {
                const Vec2i at = lattice.first_texel({x, y}) + lattice.texel(cell);
                EXPECT_TRUE(at.x >= texels.x0 && at.x < texels.x1 && at.y >= texels.y0 &&
                            at.y < texels.y1);
            }
}

TEST(SampleTable, RefusesWhatItCannotIndex) {
    EXPECT_THROW(SampleTable(make_options(0, Sampling::Independent), Camera()), SceneError);
    EXPECT_THROW(SampleTable(make_options(70000, Sampling::Independent), Camera()), SceneError);
}

/// Mean of f(t) over the shutter's density, by a fine midpoint rule on the opening itself.
double expectation(const std::vector<float>& opening, double (*f)(double)) {
    double sum = 0, weight = 0;
    for (int i = 0; i < 100000; ++i) {
        const double t = (i + .5) / 100000, place = t * static_cast<double>(opening.size() - 1);
        const auto k = static_cast<std::size_t>(place);
        const double a = std::max(0.0f, opening[k]), b = std::max(0.0f, opening[k + 1]);
        const double w = a + (place - static_cast<double>(k)) * (b - a);
        sum += w * f(t);
        weight += w;
    }
    return sum / weight;
}

TEST(ShutterWarp, TimesHaveTheOpeningsDensity) {
    const std::vector<std::vector<float>> openings = {
        {0, 1, 0}, {1, 0}, {0, 0, 1, 1, 0}, {0, .2f, .9f, 1, 1, .3f, 0, 0}, {2, 2}};
    for (const auto& opening : openings) {
        const ShutterWarp warp(opening);
        double mean = 0, square = 0;
        float last = 0;
        const int n = 100000;
        for (int i = 0; i < n; ++i) {
            const float t = warp.time((static_cast<float>(i) + .5f) / n);
            ASSERT_GE(t, last);
            last = t;
            mean += t / static_cast<double>(n);
            square += static_cast<double>(t) * t / n;
        }
        // Chords of 4096 cells: the largest error of a time where the opening is 0 is 1 /
        // sqrt(4096) of a cell's share, far below 1e-4 in the mean.
        EXPECT_NEAR(mean, expectation(opening, [](double t) { return t; }), 1e-4);
        EXPECT_NEAR(square, expectation(opening, [](double t) { return t * t; }), 1e-4);
    }
    EXPECT_TRUE(ShutterWarp({}).is_box());
    EXPECT_TRUE(ShutterWarp({0, 0, 0}).is_box());
    EXPECT_TRUE(ShutterWarp({-1, -1}).is_box());
}

TEST(ShutterWarp, TimesLeadBackToTheirNumbers) {
    // The opening's integral: 2 t^2 up to the middle of a tent.
    const ShutterWarp tent({0, 1, 0});
    for (const float t : {0.0f, .1f, .25f, .5f}) EXPECT_NEAR(tent.uniform(t), 2 * t * t, 1e-6);
    EXPECT_NEAR(tent.uniform(.75f), .875f, 1e-6);
    // Closed at both ends.
    const ShutterWarp late({0, 0, 1, 1, 0, 0});
    EXPECT_EQ(late.uniform(0.0f), 0.0f);
    EXPECT_EQ(late.uniform(.15f), 0.0f);
    EXPECT_NEAR(late.uniform(.5f), .5f, 1e-6);
    EXPECT_EQ(late.uniform(1.0f), 1.0f);
    EXPECT_EQ(ShutterWarp({}).uniform(.37f), .37f);
}

struct Moments {
    double u = 0, v = 0, uu = 0, vv = 0, uv = 0;
};

Moments lens_moments(const LensShape& lens) {
    const int n = 504;  // a multiple of every number of wedges below
    std::vector<float> u, v;
    for (int i = 0; i < n * n; ++i) {
        u.push_back((static_cast<float>(i % n) + .5f) / n);
        v.push_back((static_cast<float>(i / n) + .5f) / n);
    }
    lens.map(u.data(), v.data(), u.size());
    Moments m;
    for (std::size_t i = 0; i < u.size(); ++i) {
        m.u += u[i] / static_cast<double>(u.size());
        m.v += v[i] / static_cast<double>(u.size());
        m.uu += static_cast<double>(u[i]) * u[i] / u.size();
        m.vv += static_cast<double>(v[i]) * v[i] / u.size();
        m.uv += static_cast<double>(u[i]) * v[i] / u.size();
    }
    return m;
}

TEST(LensShape, DiscHasADiscsMoments) {
    const Moments m = lens_moments(LensShape(0, 0, Vec2f(1)));
    EXPECT_NEAR(m.u, 0, 1e-5);
    EXPECT_NEAR(m.uu, .25, 1e-5);
    EXPECT_NEAR(m.vv, .25, 1e-5);
    EXPECT_NEAR(m.uv, 0, 1e-5);
    EXPECT_NEAR(lens_moments(LensShape(0, 0, Vec2f(.5f, 1))).uu, .0625, 1e-5);
}

TEST(LensShape, PolygonsHaveTheirMoments) {
    for (const int blades : {3, 4, 6, 9}) {
        const Moments m = lens_moments(LensShape(blades, .3f, Vec2f(1)));
        // Polar second moment of a regular polygon with circumradius 1, per area.
        const double polar = (2 + std::cos(2 * M_PI / blades)) / 6;
        EXPECT_NEAR(m.u, 0, 1e-4);
        EXPECT_NEAR(m.uu + m.vv, polar, 1e-4) << blades;
        EXPECT_NEAR(m.uu, polar / 2, 1e-4) << blades;
    }
    // A side, not a corner, faces the rotation's direction: the square with rotation 0 is upright.
    std::vector<float> u{.999999f}, v{.5f};
    LensShape(4, 0, Vec2f(1)).map(u.data(), v.data(), 1);
    EXPECT_NEAR(std::fabs(u[0]) + std::fabs(v[0]), std::sqrt(.5), 1e-3);
}

}  // namespace
}  // namespace granita
