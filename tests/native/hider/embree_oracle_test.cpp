// SPDX-License-Identifier: GPL-3.0-or-later
// An independent oracle: Embree's robust ray casts through the samples, at their times.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <random>

#include "executor_test.h"

namespace granita::test {
namespace {

class EmbreeOracle : public ExecutorTest {};
GRANITA_STORING_EXECUTORS(EmbreeOracle);

/// The micropolygons of one grid as pairs of triangles with the same diagonal.
RTCScene make_scene(RTCDevice device, const std::vector<Grid>& grids) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    for (const Grid& grid : grids) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        const auto knots = static_cast<unsigned>(grid.motion ? grid.knots : 1);
        rtcSetGeometryTimeStepCount(geometry, knots);
        for (unsigned knot = 0; knot < knots; ++knot) {
            auto* vertices = static_cast<Vec3f*>(
                rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, knot, RTC_FORMAT_FLOAT3,
                                        sizeof(Vec3f), grid.vertex_count()));
            std::copy_n(grid.positions.begin() + knot * grid.vertex_count(), grid.vertex_count(),
                        vertices);
        }
        auto* triangles = static_cast<unsigned*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(unsigned), 2 * grid.micropolygon_count()));
        for (int m = 0; m < grid.micropolygon_count(); ++m) {
            const Grid::Corners c = grid.corners(m);
            for (const int v : {c.v0, c.v1, c.v2, c.v0, c.v2, c.v3})
                *triangles++ = static_cast<unsigned>(v);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    return scene;
}

/// z of the nearest surface that is seen from a point of the lens, where z is 0; `direction` has
/// z = 1.  Infinity = none.
float cast(RTCScene scene, const Vec2f& lens, const Vec3f& direction, float time, int& micropolygon,
           unsigned& grid) {
    RTCRayHit ray{};
    ray.ray.time = time;
    ray.ray.org_x = lens.x;
    ray.ray.org_y = lens.y;
    ray.ray.dir_x = direction.x;
    ray.ray.dir_y = direction.y;
    ray.ray.dir_z = direction.z;
    ray.ray.tnear = .1f;
    ray.ray.tfar = INFINITY;
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return INFINITY;
    micropolygon = static_cast<int>(ray.hit.primID / 2);
    grid = ray.hit.geomID;
    return ray.ray.tfar;
}

/// Bent grids that overlap; with three knots they turn and come nearer by up to 60 pixels.  `lens`:
/// knots of (radius, focus distance), through which they are out of focus by a few pixels.
void expect_embrees_surfaces(HiderMaker make, int knots, const std::vector<Vec2d>& lens = {}) {
    std::mt19937 random(12);
    std::uniform_real_distribution<float> uniform(-1, 1);
    Shot shot;
    shot.options.samples = 64;
    shot.camera = pinhole_camera(100);
    if (!lens.empty()) shot.camera.lens = LensKnots(lens, shot.camera.projection);
    shot.tiles = {-1, -1, 1, 1};
    for (int g = 0; g < 5; ++g) {
        const Vec3f at(uniform(random), uniform(random), 9 + 2 * uniform(random));
        const float turn = 3 * uniform(random), tilt = uniform(random);
        const Vec3f way(uniform(random), uniform(random), uniform(random));
        shot.grids.push_back(make_grid(21, 18, knots, [=](float u, float v, int k) {
            const auto t = static_cast<float>(k);
            const float a = 2.4f * (u - .5f), b = 2.0f * (v - .5f), angle = turn + .3f * t;
            return at + (t - 1) * way * (knots > 1 ? 1.f : 0.f) +
                   Vec3f(a * std::cos(angle) - b * std::sin(angle),
                         a * std::sin(angle) + b * std::cos(angle),
                         tilt * a + .3f * std::sin(7 * u + t) * std::cos(5 * v));
        }));
    }
    const SampleTable table(shot.options, shot.camera);
    const HiderFrame frame{&table, shot.camera.projection};
    const auto hider = make(frame, shot.tiles, {-16, -16, 16, 16});
    for (const Grid& grid : shot.grids) hider->hide(grid);
    const auto& stores = hider->finish();

    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = make_scene(device, shot.grids);
    int compared = 0, differ = 0, wrong = 0, covered = 0;
    for (std::size_t tile = 0; tile < stores.size(); ++tile) {
        const TileSamples& samples = hider->tile_samples(tile);
        for (std::size_t i = 0; i < samples.x.size(); ++i) {
            const auto ray = [&](float dx, float dy, int& m, unsigned& g) {
                const auto x = static_cast<float>(stores[tile].tile.x * 16) + samples.x[i] + dx;
                const auto y = static_cast<float>(stores[tile].tile.y * 16) + samples.y[i] + dy;
                const float time = samples.t.empty() ? 0.f : samples.t[i];
                // A thin lens: all rays of a place on the raster meet in the plane of focus.
                const Projection& projection = shot.camera.projection;
                Vec2f at(0.0f), bend(0.0f);
                if (projection.has_lens()) {
                    at = Vec2f(samples.u[i], samples.v[i]) *
                         static_cast<float>(projection.lens_radius);
                    bend = at * (samples.inverse_focus.empty()
                                     ? static_cast<float>(1 / projection.focus)
                                     : samples.inverse_focus[i]);
                }
                return cast(scene, at, Vec3f(x / 100 - bend.x, y / 100 - bend.y, 1), time, m, g);
            };
            const auto agrees = [&](float z, int m, unsigned g) {
                if (std::isinf(z)) return stores[tile].id[i] == kNoSurface;
                const GridPool::Place place = stores[tile].id[i] == kNoSurface
                                                  ? GridPool::Place{}
                                                  : hider->pool().locate(stores[tile].id[i]);
                return place.grid == &shot.grids[g] && place.micropolygon == m;
            };
            int m = 0;
            unsigned g = 0;
            ++compared;
            const float z = ray(0, 0, m, g);
            covered += !std::isinf(z);
            if (agrees(z, m, g)) {
                if (!std::isinf(z)) {
                    EXPECT_WITHIN(stores[tile].key[i] * z, 1, 1e-5);
                }
                continue;
            }
            // Allowed only if what the hider saw is seen within 1e-3 pixel.
            ++differ;
            bool near_edge = false;
            for (const auto& [dx, dy] : {std::pair{1e-3f, 0.f},
                                         {-1e-3f, 0.f},
                                         {0.f, 1e-3f},
                                         {0.f, -1e-3f},
                                         {7e-4f, 7e-4f},
                                         {-7e-4f, 7e-4f},
                                         {7e-4f, -7e-4f},
                                         {-7e-4f, -7e-4f}}) {
                const float there = ray(dx, dy, m, g);
                near_edge = near_edge || agrees(there, m, g);
            }
            wrong += !near_edge;
        }
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    EXPECT_EQ(wrong, 0) << differ << " differ of " << compared;
    EXPECT_LT(differ, compared / 200);  // about 4 edges a pixel, 2e-3 of it next to them
    EXPECT_GT(covered, compared / 4);
}

TEST_P(EmbreeOracle, SeesTheSameSurfaces) {
    expect_embrees_surfaces(GetParam(), 1);
}

TEST_P(EmbreeOracle, SeesTheSameMovingSurfaces) {
    expect_embrees_surfaces(GetParam(), 3);
}

TEST_P(EmbreeOracle, SeesTheSameSurfacesThroughALens) {
    expect_embrees_surfaces(GetParam(), 1, {{.8, 9}});
}

TEST_P(EmbreeOracle, SeesTheSameMovingSurfacesThroughALensThatOpensAndRefocuses) {
    expect_embrees_surfaces(GetParam(), 3, {{.2, 12}, {.8, 9}, {.5, 7}});
}

}  // namespace
}  // namespace granita::test
