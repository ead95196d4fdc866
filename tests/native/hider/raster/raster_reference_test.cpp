// SPDX-License-Identifier: GPL-3.0-or-later
// The raster executor against the reference hider, sample by sample: still, moving, through a lens.
//
// OpenGL moves every vertex to a grid of 2^-8 texel (GL_SUBPIXEL_BITS is 8 in most drivers, at
// least 4 in all), so an edge lies within half a diagonal of that grid of where it should be:
// samples within one unit of an edge of either winner may differ.  Its depth moves with it and is
// interpolated in float: winners may also differ where their depths are that close.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <tuple>

#include "hider/hider.h"
#include "hider/raster/raster_hider.h"
#include "hider/raster/raster_samples.h"
#include "raster_scene.h"

namespace granita::raster_test {
namespace {

constexpr int kSide = 4;  // of the lattice; turned where there are several passes

struct Sample {
    std::int32_t grid = -1, micropolygon = -1;
    float key = -std::numeric_limits<float>::infinity();
};

struct TestScene {
    Projection projection;
    Rect pixels;
    std::vector<Grid> grids;
    int passes = 1;
    Sampling sampling = Sampling::Regular;

    SampleNeeds needs() const { return {passes > 1, projection.has_lens()}; }  // of the passes
    SampleTable table() const {
        Options options;
        options.sampling = sampling;
        options.samples = kSide * kSide;
        options.time_samples = passes;
        Camera camera;
        camera.projection = projection;
        return SampleTable(options, camera, needs());
    }
};

/// [passes], each as RasterSurfaces.
std::vector<std::vector<Sample>> reference_samples(const TestScene& scene) {
    const SampleTable table = scene.table();
    HiderFrame frame;
    frame.table = &table;
    frame.projection = scene.projection;
    const Rect tiles{0, 0, (scene.pixels.x1 + kTileSize - 1) / kTileSize,
                     (scene.pixels.y1 + kTileSize - 1) / kTileSize};
    const auto hider = make_reference_hider(frame, tiles, scene.pixels);
    for (const Grid& grid : scene.grids) hider->hide(grid);

    const bool regular = scene.sampling == Sampling::Regular;
    const int width = scene.pixels.width();
    const int cells = regular ? table.lattice().cells() : table.samples();  // of a pass
    const std::size_t count = static_cast<std::size_t>(width) * scene.pixels.height() * cells;
    std::vector<std::vector<Sample>> samples(table.samples() / cells, std::vector<Sample>(count));
    for (const TileStore& store : hider->finish())
        for (std::size_t i = 0; i < store.id.size(); ++i) {
            const int pixel = static_cast<int>(i) / table.samples();
            const int pass = static_cast<int>(i) % table.samples() / cells;
            const int s = static_cast<int>(i) % cells;
            const int x = store.tile.x * kTileSize + pixel % kTileSize;
            const int y = store.tile.y * kTileSize + pixel / kTileSize;
            if (store.id[i] == kNoSurface || x >= scene.pixels.x1 || y >= scene.pixels.y1) continue;
            const GridPool::Place place = hider->pool().locate(store.id[i]);
            samples[pass][static_cast<std::size_t>(y * width + x) * cells + s] = {
                static_cast<std::int32_t>(place.grid - scene.grids.data()), place.micropolygon,
                store.key[i]};
        }
    return samples;
}

struct Triangle {
    Vec2d p[3];  ///< texels
    double key[3];
};

Vec3d position_at(const Grid& grid, int vertex, double t) {
    if (!grid.motion) return Vec3d(grid.positions[vertex]);
    const double place = t * (grid.knots - 1);
    const int k = std::min(static_cast<int>(place), grid.knots - 2), n = grid.vertex_count();
    return glm::mix(Vec3d(grid.positions[k * n + vertex]),
                    Vec3d(grid.positions[(k + 1) * n + vertex]), place - k);
}

/// The two triangles of a micropolygon wholly in front of the near plane, in one pass.
std::array<Triangle, 2> triangles(const TestScene& scene, const RasterPass& pass, double texels,
                                  const Sample& sample) {
    const Grid& grid = scene.grids[sample.grid];
    const Grid::Corners c = grid.corners(sample.micropolygon);
    const int vertices[2][3] = {{c.v0, c.v1, c.v2}, {c.v0, c.v2, c.v3}};
    std::array<Triangle, 2> result;
    for (int t = 0; t < 2; ++t)
        for (int i = 0; i < 3; ++i) {
            const Projection& projection = scene.projection;
            const Vec3d p = position_at(grid, vertices[t][i], pass.t);
            const Vec2d lens = Vec2d(pass.u, pass.v) * projection.lens_radius;
            const double w = projection.perspective ? p.z : 1.0;
            result[t].p[i] =
                (projection.scale * (Vec2d(p) + lens * (p.z / projection.focus - 1.0)) / w +
                 projection.center) *
                texels;
            result[t].key[i] = scene.projection.perspective ? 1.0 / p.z : -p.z;
        }
    return result;
}

/// Distance to the nearest of the lines through the triangles' edges, texels.
double edge_distance(const std::array<Triangle, 2>& triangles, const Vec2d& at) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles)
        for (int i = 0; i < 3; ++i) {
            const Vec2d a = t.p[i], d = t.p[(i + 1) % 3] - a;
            const double length = std::hypot(d.x, d.y);
            if (length == 0.0) continue;
            nearest = std::min(nearest, std::abs(d.x * (at.y - a.y) - d.y * (at.x - a.x)) / length);
        }
    return nearest;
}

/// Largest change of the key over one texel in x plus one in y.
double key_slope(const std::array<Triangle, 2>& triangles) {
    double slope = 0.0;
    for (const Triangle& t : triangles) {
        const Vec2d a = t.p[1] - t.p[0], b = t.p[2] - t.p[0];
        const double area = a.x * b.y - a.y * b.x;
        if (area == 0.0) continue;
        const double ka = t.key[1] - t.key[0], kb = t.key[2] - t.key[0];
        slope = std::max(
            slope, std::abs((ka * b.y - kb * a.y) / area) + std::abs((kb * a.x - ka * b.x) / area));
    }
    return slope;
}

struct Differences {
    int seen = 0, at_edges = 0, in_depth = 0, unexplained = 0, wrong_keys = 0;
};

void compare_pass(const TestScene& scene, const RasterPass& pass, double unit,
                  const RasterSurfaces& drawn, const std::vector<Sample>& expected,
                  Differences& d) {
    const RegularLattice lattice = scene.table().lattice();
    const int width = scene.pixels.width(), cells = lattice.cells();
    const double texels = std::sqrt(cells);  // a pixel; turned or not
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const Sample a{drawn.surface[i].grid, drawn.surface[i].micropolygon, drawn.key[i]};
        const Sample& b = expected[i];
        d.seen += b.grid >= 0;
        if (a.grid < 0 && b.grid < 0) continue;
        const int pixel = static_cast<int>(i) / cells;
        const Vec2d at = texels * (Vec2d(pixel % width, pixel / width) +
                                   Vec2d(lattice.place(static_cast<int>(i) % cells)));
        double distance = std::numeric_limits<double>::infinity(), slope = 0.0;
        for (const Sample& s : {a, b}) {
            if (s.grid < 0) continue;
            const auto t = triangles(scene, pass, texels, s);
            distance = std::min(distance, edge_distance(t, at));
            slope = std::max(slope, key_slope(t));
        }
        // The plane's value at a corner of the target, up to 272 texels away, is rounded too.
        const double largest = std::max<double>(std::abs(std::max(a.key, b.key)), 272.0 * slope);
        const double key_tolerance = slope * unit + 4.0 * 0x1p-24 * largest;
        const bool close = std::abs(static_cast<double>(a.key) - b.key) <= 2.0 * key_tolerance;
        const bool same = a.grid == b.grid && a.micropolygon == b.micropolygon;
        if (same && close) continue;
        if (distance <= unit)
            ++d.at_edges;  // where a micropolygon folds, of its other triangle too
        else if (same)
            ++d.wrong_keys;
        else if (close)
            ++d.in_depth;
        else
            ++d.unexplained;
    }
}

Differences compare(const TestScene& scene) {
    GLint subpixel_bits = 0;
    gl_thread().run([&] { glGetIntegerv(GL_SUBPIXEL_BITS, &subpixel_bits); });
    const double unit = std::ldexp(1.0, -subpixel_bits);
    RasterFrame frame;
    frame.projection = scene.projection;
    frame.filter = box_filter(scene.table().lattice());
    frame.passes = raster_passes(scene.table(), scene.needs(), scene.projection);
    RasterHider hider(gl_thread(), frame);
    const auto bucket = hider.open(scene.pixels, pointers(scene.grids));
    const auto expected = reference_samples(scene);
    EXPECT_EQ(expected.size(), frame.passes.size());

    Differences d;
    for (std::size_t pass = 0; pass < expected.size(); ++pass)
        compare_pass(scene, frame.passes[pass], unit, bucket->surfaces(static_cast<int>(pass)),
                     expected[pass], d);
    return d;
}

/// Sheets of random, crumpled micropolygons of about `size` pixels that overlap and intersect.
TestScene crumpled(bool perspective, float size, unsigned seed) {
    TestScene scene;
    scene.pixels = {0, 0, 48, 48};
    scene.projection = perspective ? perspective_projection(48, 48) : pixel_projection();
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> jitter(-0.35f, 0.35f), depth(2.0f, 6.0f);
    for (std::uint32_t k = 0; k < 5; ++k) {
        const int n = static_cast<int>(30.0f / size);
        const float x0 = 18.0f * (k % 2), y0 = 9.0f * (k / 2), z0 = depth(random);
        scene.grids.push_back(make_grid(k, n, n, [&](float u, float v) {
            const float x = x0 + 30 * u + size * jitter(random);
            const float y = y0 + 30 * v + size * jitter(random);
            const float z = z0 + 0.5f * jitter(random) + u - v;
            return perspective ? Vec3f((x - 24) / 24 * z, (y - 24) / 24 * z, z) : Vec3f(x, y, z);
        }));
    }
    return scene;
}

enum class Blur { None, Motion, Lens, Both };

/// Motion of up to 12 pixels with 2, 3 or 4 knots a grid, or none; circles of confusion of up to 8.
TestScene blurred(TestScene scene, Blur blur, unsigned seed) {
    if (blur == Blur::None) return scene;
    scene.passes = blur == Blur::Lens ? 1 : 5;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> shift(-1.0f, 1.0f);
    if (blur != Blur::Lens)
        for (std::size_t g = 0; g < scene.grids.size(); ++g) {
            const float pixel = scene.projection.perspective ? 3.0f / 24.0f : 1.0f;
            std::vector<Vec3f> shifts(g % 4);
            for (Vec3f& s : shifts)
                s = {6 * pixel * shift(random), 6 * pixel * shift(random), 0.5f * shift(random)};
            if (!shifts.empty()) set_motion(scene.grids[g], shifts);
        }
    if (blur != Blur::Motion) {
        scene.passes = 5;
        scene.projection.focus = 3.5;
        scene.projection.lens_radius = scene.projection.perspective ? 0.3 : 4.0;
    }
    return scene;
}

class RasterReference : public testing::TestWithParam<std::tuple<bool, Blur>> {};

TEST_P(RasterReference, samples_differ_only_at_edges_and_equal_depths) {
    const auto [perspective, blur] = GetParam();
    Differences sum;
    for (const float size : {0.7f, 3.0f, 15.0f})
        for (unsigned seed = 1; seed <= 3; ++seed) {
            SCOPED_TRACE(testing::Message() << "size " << size << ", seed " << seed);
            const Differences d = compare(blurred(crumpled(perspective, size, seed), blur, seed));
            EXPECT_EQ(d.unexplained, 0);
            EXPECT_EQ(d.wrong_keys, 0);
            EXPECT_GT(d.seen, 20000);
            sum.at_edges += d.at_edges;
            sum.in_depth += d.in_depth;
            sum.seen += d.seen;
        }
    RecordProperty("samples_seen", sum.seen);
    RecordProperty("differ_at_edges", sum.at_edges);
    RecordProperty("differ_in_depth", sum.in_depth);
    // The smallest micropolygons, 2.8 texels a side, have two sides and a diagonal each: 9.6 texels
    // of edge in 7.8 square texels, so 2 x 2^-8 x 1.2 of the samples lie within a unit of an edge.
    EXPECT_LT(sum.at_edges, sum.seen / 100);
    // Sheets meet in lines; only next to those are depths so close.
    EXPECT_LT(sum.in_depth, sum.seen / 1000);
}

std::string name_of(Blur blur) {
    constexpr const char* kBlurs[] = {"still", "motion", "lens", "motion_and_lens"};
    return kBlurs[static_cast<int>(blur)];
}

std::string projection_name(const testing::TestParamInfo<std::tuple<bool, Blur>>& info) {
    return (std::get<0>(info.param) ? "perspective_" : "orthographic_") +
           name_of(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Projections, RasterReference,
                         testing::Combine(testing::Bool(), testing::Values(Blur::None, Blur::Motion,
                                                                           Blur::Lens, Blur::Both)),
                         projection_name);

/// Per-pixel time sampling: what every sample sees, at its own place, time and lens point.
class RasterSampling : public testing::TestWithParam<std::tuple<Sampling, Blur>> {};

TEST_P(RasterSampling, samples_see_what_the_reference_sees) {
    const auto [sampling, blur] = GetParam();
    int seen = 0, other = 0, far_keys = 0;
    for (unsigned seed = 1; seed <= 3; ++seed) {
        TestScene scene = blurred(crumpled(true, 6.0f, seed), blur, seed);
        scene.sampling = sampling;
        const SampleTable table = scene.table();
        RasterFrame frame;
        frame.projection = scene.projection;
        frame.filter = make_gathering_filter(sample_lattice(table.samples()), 0.5, true,
                                             [](double) { return 1.0; });
        frame.table = &table;
        frame.needs = scene.needs();
        RasterHider hider(gl_thread(), frame);
        const RasterSurfaces drawn = hider.open(scene.pixels, pointers(scene.grids))->surfaces();
        const std::vector<Sample> expected = reference_samples(scene).at(0);
        ASSERT_EQ(drawn.surface.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const Sample& e = expected[i];
            seen += e.grid >= 0;
            if (drawn.surface[i].grid != e.grid || drawn.surface[i].micropolygon != e.micropolygon)
                ++other;
            else if (e.grid >= 0)
                far_keys += std::abs(drawn.key[i] - e.key) > 4 * 0x1p-23f * std::abs(e.key);
        }
    }
    EXPECT_GT(seen, 30000);
    RecordProperty("samples_seen", seen);
    RecordProperty("other_surface", other);
    // Within 2^-12 pixel of an edge, or where two sheets meet: as between the CPU's executors.
    EXPECT_LE(other, seen * 4.0 / 2048);
    EXPECT_EQ(far_keys, 0);
}

std::string sampling_name(const testing::TestParamInfo<std::tuple<Sampling, Blur>>& info) {
    return (std::get<0>(info.param) == Sampling::Independent ? "independent_" : "interleaved_") +
           name_of(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(
    Samples, RasterSampling,
    testing::Combine(testing::Values(Sampling::Independent, Sampling::Interleaved),
                     testing::Values(Blur::None, Blur::Motion, Blur::Lens, Blur::Both)),
    sampling_name);

TEST(RasterReferencePlane, ground_through_the_eye_has_no_holes_up_to_the_horizon) {
    // Hard case 47: a plane one metre below the eye from 50 m behind to 90 m before it.
    TestScene scene;
    scene.pixels = {0, 0, 48, 48};
    scene.projection = perspective_projection(48, 48);
    scene.grids.push_back(make_grid(
        1, 7, 28, [](float u, float v) { return Vec3f(400 * u - 200, -1, 140 * v - 50); }));
    RasterFrame frame;
    frame.projection = scene.projection;
    frame.filter = box_filter(kSide);
    RasterHider hider(gl_thread(), frame);
    const RasterSurfaces drawn = hider.open(scene.pixels, pointers(scene.grids))->surfaces();
    const std::vector<Sample> expected = reference_samples(scene).at(0);
    // The plane's far edge at z = 90 lies 24 / 90 pixels below the horizon at y = 24.
    const double far_edge = 24.0 - 24.0 / 90.0;
    constexpr int kCells = kSide * kSide;
    ASSERT_EQ(expected.size(), std::size_t{48} * 48 * kCells);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const int s = static_cast<int>(i) % kCells, row = static_cast<int>(i) / kCells / 48;
        const double y = row + (s / kSide + 0.5) / kSide;
        EXPECT_EQ(drawn.surface[i].grid, y < far_edge ? 0 : -1) << "sample " << i;
        EXPECT_EQ(drawn.surface[i].grid, expected[i].grid) << "sample " << i;
        if (y >= far_edge) continue;
        // Vertices behind the eye are clipped: a unit of 2^-8 texel of slope, and rounding.
        EXPECT_WITHIN(drawn.key[i], (24.0 - y) / 24.0, 0x1p-8 / (24.0 * kSide) + 1e-6) << i;
    }
}

}  // namespace
}  // namespace granita::raster_test
