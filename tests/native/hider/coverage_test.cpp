// SPDX-License-Identifier: GPL-3.0-or-later
// Closed tilings, degenerate micropolygons, depth order: hard cases 48 to 52, 58 and 60.
#include <limits>
#include <random>

#include "executor_test.h"

namespace granita::test {
namespace {

class Coverage : public ExecutorTest {};
GRANITA_ALL_EXECUTORS(Coverage);
class Dropped : public ExecutorTest {};
GRANITA_STORING_EXECUTORS(Dropped);

/// Every sample must lie in exactly one micropolygon of the half-transparent tiling.
void expect_covered_once(HiderMaker make, Shot& shot) {
    for (Grid& grid : shot.grids) set_color(grid, Vec3f(1), Vec3f(0.5f));
    const std::vector<int> layers = layers_per_sample(make, shot);
    int wrong = 0;
    for (const int n : layers) wrong += n != 1;
    EXPECT_EQ(wrong, 0) << "of " << layers.size();
}

TEST_P(Coverage, EdgesAndVerticesOnSamples) {
    // Samples at multiples of 1/4 plus 1/8: vertices on samples, edges and diagonals through them.
    Shot shot;
    shot.options.samples = 16;
    shot.options.sampling = Sampling::Regular;
    shot.grids.push_back(rectangle(-.125f, -.125f, 16.125f, 16.125f, 5, 65, 65));
    expect_covered_once(GetParam(), shot);
    shot.grids[0] = rectangle(16.125f, -.125f, -.125f, 16.125f, 5, 65, 65);  // mirrored
    expect_covered_once(GetParam(), shot);
    shot.grids[0] = rectangle(-2.375f, -2.375f, 18.125f, 18.125f, 5, 41, 82);  // every second edge
    expect_covered_once(GetParam(), shot);
}

TEST_P(Coverage, ShearedTilingsWithEdgesOnSamples) {
    Shot shot;
    shot.options.samples = 16;
    shot.options.sampling = Sampling::Regular;
    for (const float shear : {1.0f, -1.0f, 2.0f, 0.5f}) {
        shot.grids.clear();
        shot.grids.push_back(make_grid(160, 160, 1, [=](float u, float v, int) {
            const float x = u * 80 - 32.125f, y = v * 80 - 32.125f;
            return Vec3f(x + shear * (y - 8.125f), y, 5);
        }));
        expect_covered_once(GetParam(), shot);
    }
}

TEST_P(Coverage, RandomTilingsInPerspectiveMovingAndDefocused) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> jitter(-.3f, .3f);
    for (int trial = 0; trial < 4; ++trial) {
        std::vector<Vec3f> offset(2 * 41 * 41);
        for (Vec3f& o : offset) o = {jitter(random), jitter(random), jitter(random)};
        Shot shot;
        shot.options.samples = 16;
        shot.camera = pinhole_camera(100);
        if (trial >= 2) {
            shot.camera.projection.lens_radius = 0.05;
            shot.camera.projection.focus = 12;
        }
        shot.grids.push_back(make_grid(40, 40, trial % 2 ? 2 : 1, [&](float u, float v, int k) {
            const int i = static_cast<int>(std::lround(u * 40)),
                      j = static_cast<int>(std::lround(v * 40));
            const Vec3f& o = offset[k * 41 * 41 + j * 41 + i];
            return Vec3f(-6 + u * 14 + .3f * o.x, -6 + v * 14 + .3f * o.y + .4f * k, 10 + o.z);
        }));
        expect_covered_once(GetParam(), shot);
    }
}

TEST_P(Coverage, BorderVerticesThatCoincideLeaveNoCrack) {
    // A grid whose left border carries one edge for seven, beside a grid of one edge; and 3 to 5.
    Shot shot;
    shot.options.samples = 16;
    shot.options.sampling = Sampling::Regular;
    for (const auto& [coarse, fine] : {std::pair{1, 7}, std::pair{3, 5}}) {
        shot.grids.clear();
        const auto border = [=](float v) {  // the coarse border's vertex that stands for this one
            return std::floor(v * coarse + .5f) / coarse;
        };
        const auto y_at = [](float v) { return -1.3f + v * 20.0f; };
        const auto curve = [](float v) { return 8.1f + 1.7f * std::sin(9.0f * v); };
        shot.grids.push_back(make_grid(5, coarse, 1, [=](float u, float v, int) {
            return Vec3f(-2 + u * (curve(border(v)) + 2), u == 1 ? y_at(border(v)) : y_at(v), 4);
        }));
        shot.grids.push_back(make_grid(5, fine, 1, [=](float u, float v, int) {
            const float left = u == 0 ? border(v) : v;
            const float x = curve(left);
            return Vec3f(u == 0 ? -2 + 1.0f * (x + 2) : x + u * (18 - x), y_at(left), 4);
        }));
        expect_covered_once(GetParam(), shot);
    }
}

TEST_P(Coverage, FarFromTheOriginLikeNearIt) {
    Shot near, far;
    near.options.samples = far.options.samples = 64;
    near.options.sampling = far.options.sampling = Sampling::Regular;
    near.options.time_samples = far.options.time_samples = 1;  // a square lattice
    near.grids.push_back(rectangle(3.25f, 2.5f, 12.25f, 9.75f, 5, 9, 7));
    far.tiles = {1023, 700, 1024, 701};
    far.grids.push_back(rectangle(16371.25f, 11202.5f, 16380.25f, 11209.75f, 5, 9, 7));
    const Picture a = render(GetParam(), near), b = render(GetParam(), far);
    for (std::size_t i = 0; i < a.combined.size(); ++i) EXPECT_EQ(a.combined[i], b.combined[i]);
    EXPECT_EQ(a.alpha(5, 5), 1.0f);
    EXPECT_EQ(a.alpha(3, 5), .75f);  // lattice of 8: 6 of 8 columns
}

TEST_P(Coverage, SliversAndDegenerateMicropolygons) {
    const float nowhere = 4.0f;
    Shot shot;
    shot.options.samples = 256;
    // No area: nothing is hit, whatever the rule for ties.
    shot.grids.push_back(rectangle(nowhere, 2, nowhere, 12, 5));
    shot.grids.push_back(rectangle(2, 2, 2, 2, 5));
    shot.grids.push_back(make_grid(
        3, 3, 1, [](float u, float v, int) { return Vec3f(1 + 8 * (u + v), 1 + 4 * (u + v), 5); }));
    for (const Vec4f& p : render(GetParam(), shot).combined) EXPECT_EQ(p, Vec4f(0));

    // 1/64 pixel wide and oblique: the area, within four times its error (docs/sampling_error.md).
    shot.grids.clear();
    shot.grids.push_back(make_grid(
        1, 40, 1, [](float u, float v, int) { return Vec3f(2 + 11 * v + u / 64, 1 + 14 * v, 5); }));
    double sum = 0;
    for (const Vec4f& p : render(GetParam(), shot).combined) sum += p.w;
    EXPECT_WITHIN(sum, 14.0 / 64, 4 * .027);

    // A bow-tie: each half once, nothing twice, no NaN; and a quad bent out of its plane has its
    // square as silhouette and the diagonal's depth in the middle.
    shot.grids.clear();
    shot.grids.push_back(make_grid(1, 1, 1, [](float u, float v, int) {
        return Vec3f(2 + 8 * (v > 0 ? 1 - u : u), 2 + 8 * v, 5);
    }));
    sum = 0;
    for (const Vec4f& p : render(GetParam(), shot).combined) sum += p.w;
    // Triangles (2,2) (10,2) (2,10) and (2,2) (2,10) (10,10): they overlap in a quarter of 64.
    EXPECT_WITHIN(sum, 48.0, 4 * .022);
    shot.grids[0] = make_grid(
        1, 1, 1, [](float u, float v, int) { return Vec3f(2 + 8 * u, 2 + 8 * v, 5 + 4 * u * v); });
    const Picture bent = render(GetParam(), shot);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            EXPECT_EQ(bent.alpha(x, y), x >= 2 && x < 10 && y >= 2 && y < 10 ? 1.0f : 0.0f);
}

TEST_P(Coverage, VerticesThatAreNotFiniteTakeOnlyTheirMicropolygonsAway) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Shot whole, broken;
        whole.grids.push_back(rectangle(0, 0, 16, 16, 5, 8, 8));
        broken.grids = whole.grids;
        broken.grids[0].positions[3 * 9 + 4].y = bad;  // vertex (4, 3): pixels 6..10 x 4..8
        const Picture a = render(GetParam(), whole), b = render(GetParam(), broken);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const bool hole = x >= 6 && x < 10 && y >= 4 && y < 8;
                EXPECT_EQ(b.at(x, y), hole ? Vec4f(0) : a.at(x, y)) << x << ' ' << y;
            }
        EXPECT_EQ(broken.statistics.get(Counter::MicropolygonsDropped), 4u);
    }
}

TEST_P(Dropped, MicropolygonsAreReportedByName) {
    Shot shot;
    Scene scene;
    scene.instances.emplace_back().name = "Cube";
    shot.grids.push_back(rectangle(0, 0, 16, 16, 5, 8, 8));
    shot.grids[0].positions[3 * 9 + 4].y = std::numeric_limits<float>::quiet_NaN();
    Report report;
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection, nullptr, &scene, &report};
    GetParam()(frame, {0, 0, 1, 1}, {0, 0, 16, 16})->hide(shot.grids[0]);
    ASSERT_EQ(report.warnings().size(), 1u);
    EXPECT_EQ(report.warnings()[0].datablock, "object 'Cube'");
    EXPECT_EQ(report.warnings()[0].count, 4u);
}

TEST_P(Coverage, PlanesTwoUlpApartKeepTheirOrder) {
    for (const float z : {1.0f, 7.3f, 1000.0f, 3.1e5f}) {
        float behind = z;  // 1/z is rounded once: two ulp of it are at most four of z
        while (1.0f / behind > std::nextafter(std::nextafter(1.0f / z, 0.0f), 0.0f))
            behind = std::nextafter(behind, INFINITY);
        Shot shot;
        shot.camera = pinhole_camera(100);
        for (const float depth : {behind, z}) {
            const float side = depth * .2f;
            shot.grids.push_back(
                rectangle(-side, -side, side, side, depth, depth == z ? 13 : 9, 7));
            set_color(shot.grids.back(), depth == z ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0));
        }
        const Picture p = render(GetParam(), shot);
        for (const Vec4f& color : p.combined) EXPECT_EQ(color, Vec4f(1, 0, 0, 1)) << z;
    }
}

TEST_P(Coverage, TenMillionToOneDepthRange) {
    Shot shot;
    shot.camera = pinhole_camera(100);
    shot.camera.projection.near_clip = 1e-3;
    shot.camera.projection.far_clip = 1e4;
    // Left to right: beyond the far clip, far, middle, near, before the near clip; each covers
    // everything to its right.
    const float depth[] = {1.01e4f, 9.9e3f, 10, 1.01e-3f, .99e-3f};
    for (int i = 0; i < 5; ++i) {
        const float s = depth[i] / 100;
        shot.grids.push_back(rectangle(s * 3 * i, 0, s * 17, s * 16, depth[i], 3, 3));
        set_color(shot.grids.back(), Vec3f(static_cast<float>(i)));
    }
    const Picture p = render(GetParam(), shot);
    EXPECT_EQ(p.alpha(1, 8), 0.0f);
    EXPECT_EQ(p.at(4, 8).x, 1.0f);
    EXPECT_EQ(p.at(7, 8).x, 2.0f);
    EXPECT_EQ(p.at(10, 8).x, 3.0f);
    EXPECT_EQ(p.at(14, 8).x, 3.0f);
}

TEST_P(Coverage, GroundPlaneThroughTheEyePlane) {
    // y = -1 from 50 m behind the camera to the horizon: below the horizon row no hole, above
    // nothing.  Horizon at pixel row 8.
    Shot shot;
    shot.camera = pinhole_camera(10);
    shot.camera.projection.center = {8, 8};
    shot.grids.push_back(make_grid(7, 9, 1, [](float u, float v, int) {
        return Vec3f(-2e5f + 4e5f * u, -1, -50 + 1e5f * v);
    }));
    set_color(shot.grids[0], Vec3f(1), Vec3f(.5f));
    const std::vector<int> layers = layers_per_sample(GetParam(), shot);
    const int n = shot.options.samples;
    for (int p = 0; p < 256; ++p)
        for (int s = 0; s < n; ++s) {
            // Row 7 ends at the horizon of y = -1 at z = 1e5, a ten thousandth of a pixel below 8.
            const int expected = p / 16 < 8 ? 1 : 0;
            if (p / 16 != 7) {
                ASSERT_EQ(layers[p * n + s], expected) << p;
            }
        }
}

TEST_P(Coverage, OrientationDoesNotMatter) {
    Shot a, b;
    a.grids.push_back(rectangle(2.3f, 3.1f, 11.7f, 12.2f, 5, 1, 1));
    b.grids.push_back(make_grid(1, 1, 1, [](float u, float v, int) {  // transposed: the back
        return Vec3f(v > 0 ? 11.7f : 2.3f, u > 0 ? 12.2f : 3.1f, 5);
    }));
    const Picture p = render(GetParam(), a), q = render(GetParam(), b);
    for (std::size_t i = 0; i < p.combined.size(); ++i) EXPECT_EQ(p.combined[i], q.combined[i]);
    EXPECT_EQ(p.alpha(6, 6), 1.0f);
}

}  // namespace
}  // namespace granita::test
