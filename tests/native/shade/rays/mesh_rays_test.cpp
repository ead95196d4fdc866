// SPDX-License-Identifier: GPL-3.0-or-later
// Which faces rays name of a mesh in its own space.
#include "shade/rays/mesh_rays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "geometry/geometry_cache.h"

namespace granita {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// Squares of a metre side by side from x = `from` on, at each height; face `i` of a height at
/// [from + i, from + i + 1].
std::shared_ptr<Scene> squares(int count, float from, const std::vector<float>& heights) {
    auto scene = std::make_shared<Scene>();
    GeometryData data;
    data.name = "mesh 'Squares'";
    for (const float z : heights) {
        const auto first = static_cast<std::int32_t>(data.points.size());
        for (int i = 0; i <= count; ++i)
            for (int j = 0; j < 2; ++j)
                data.points.emplace_back(from + static_cast<float>(i), static_cast<float>(j), z);
        for (int i = 0; i < count; ++i)
            for (const int corner : {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1})
                data.corner_verts.push_back(first + corner);
    }
    data.face_sizes.assign(static_cast<std::size_t>(count) * heights.size(), 4);
    data.smooth.assign(data.face_sizes.size(), 0);
    scene->geometries.push_back(std::move(data));
    return scene;
}

/// What rays downwards meet.
struct Meshes {
    explicit Meshes(std::shared_ptr<Scene> of, std::function<bool(std::uint32_t)> passes = {})
        : scene(std::move(of)),
          shared(cache.shared(*scene, 0, report)),
          store(*scene, nullptr, progress),
          rays(store.mesh(0, shared, passes != nullptr), *shared, passes) {}
    std::vector<std::uint32_t> at(float x, float y, const Rounding& rounding = {Mat3f(1), 1e-3f},
                                  float time = 0.5f) const {
        std::vector<std::uint32_t> patches;
        MeshRays::Work work;
        rays.meet({{x, y, 10.0f}, {0.0f, 0.0f, -1.0f}, INFINITY, time}, rounding, patches, work);
        return patches;
    }
    std::shared_ptr<Scene> scene;
    Report report;
    Progress progress;
    GeometryCache cache;
    std::shared_ptr<const SharedGeometry> shared;
    MeshRayStore store;
    MeshRays rays;
};

TEST(MeshRays, a_face_is_met_alone_but_close_to_an_edge_with_its_neighbour) {
    const Meshes mesh(squares(3, 0.0f, {0.0f}));
    EXPECT_THAT(mesh.at(1.3f, 0.4f), ElementsAre(1));
    EXPECT_THAT(mesh.at(1.01f, 0.4f), ElementsAre(1));
    EXPECT_THAT(mesh.at(1.0002f, 0.4f), ElementsAre(1, 0));
    EXPECT_THAT(mesh.at(1.9998f, 0.4f), ElementsAre(1, 2));
    // The edge within it is none, an outline has nothing beyond.
    EXPECT_THAT(mesh.at(1.5001f, 0.5f), ElementsAre(1));
    EXPECT_THAT(mesh.at(0.0002f, 0.4f), ElementsAre(0));
    EXPECT_THAT(mesh.at(-0.0002f, 0.4f), IsEmpty());
}

TEST(MeshRays, close_is_what_rounding_is_where_it_is_measured) {
    const Meshes mesh(squares(3, 0.0f, {0.0f}));
    EXPECT_THAT(mesh.at(1.03f, 0.4f, {Mat3f(1.0f), 0.05f}), ElementsAre(1, 0));
    EXPECT_THAT(mesh.at(1.03f, 0.4f, {Mat3f(2.0f), 0.05f}), ElementsAre(1));
    EXPECT_THAT(mesh.at(1.02f, 0.4f, {Mat3f(2.0f), 0.05f}), ElementsAre(1, 0));
}

/// A fan of `count` thin triangles around the origin, one metre long.
std::shared_ptr<Scene> fan(int count) {
    auto scene = std::make_shared<Scene>();
    GeometryData data;
    data.name = "mesh 'Fan'";
    data.points.emplace_back(0.0f);
    for (int i = 0; i < count; ++i) {
        const float angle = 2.0f * 3.14159265f * static_cast<float>(i) / static_cast<float>(count);
        data.points.emplace_back(std::cos(angle), std::sin(angle), 0.0f);
        for (const int corner : {0, i + 1, (i + 1) % count + 1})
            data.corner_verts.push_back(corner);
    }
    data.face_sizes.assign(static_cast<std::size_t>(count), 3);
    data.smooth.assign(static_cast<std::size_t>(count), 0);
    scene->geometries.push_back(std::move(data));
    return scene;
}

TEST(MeshRays, at_a_corner_all_that_meet_there_are_met) {
    const auto met = Meshes(fan(8)).at(4e-4f, 1e-4f, {Mat3f(1.0f), 1e-3f});
    EXPECT_THAT(std::set<std::uint32_t>(met.begin(), met.end()).size(), 8u);
    EXPECT_THAT(Meshes(fan(8)).at(0.1f, 0.02f, {Mat3f(1.0f), 1e-3f}), ElementsAre(0));
}

TEST(MeshRays, faces_smaller_than_rounding_are_told) {
    const Meshes mesh(squares(3, 0.0f, {0.0f}));
    std::vector<std::uint32_t> patches;
    MeshRays::Work work;
    const Ray down{{1.3f, 0.4f, 10.0f}, {0.0f, 0.0f, -1.0f}, INFINITY};
    mesh.rays.meet(down, {Mat3f(1.0f), 0.01f}, patches, work);
    EXPECT_EQ(work.met, 1u);
    EXPECT_EQ(work.unsure, 0u);
    mesh.rays.meet(down, {Mat3f(1.0f), 0.2f}, patches, work);
    EXPECT_EQ(work.met, 2u);
    EXPECT_EQ(work.unsure, 1u);
}

TEST(MeshRays, edges_are_where_they_are_at_the_ray_s_time) {
    auto scene = squares(3, 0.0f, {0.0f});
    GeometryData moving = scene->geometries[0];
    moving.knots = 2;
    for (std::size_t i = 0, n = moving.points.size(); i < n; ++i)
        moving.points.push_back(moving.points[i] + Vec3f(0.5f, 0.0f, 0.0f));
    scene->geometries = {};
    scene->geometries.push_back(std::move(moving));
    const Meshes mesh(scene);
    EXPECT_THAT(mesh.at(1.0002f, 0.4f, {Mat3f(1.0f), 1e-3f}, 0.0f), ElementsAre(1, 0));
    EXPECT_THAT(mesh.at(1.2502f, 0.4f, {Mat3f(1.0f), 1e-3f}, 0.5f), ElementsAre(1, 0));
    EXPECT_THAT(mesh.at(1.5002f, 0.4f, {Mat3f(1.0f), 1e-3f}, 1.0f), ElementsAre(1, 0));
}

TEST(MeshRays, faces_on_each_other_are_met_together) {
    const std::vector<float> heights{1.0f, 1.0f, 0.0f};
    EXPECT_THAT(Meshes(squares(1, 0.0f, heights)).at(0.3f, 0.4f),
                ::testing::IsSupersetOf({0u, 1u}));
}

TEST(MeshRays, what_lies_behind_is_met_where_light_comes_through) {
    const std::vector<float> heights{4.0f, 3.0f, 2.0f, 1.0f};
    EXPECT_THAT(Meshes(squares(1, 0.0f, heights)).at(0.3f, 0.4f), ElementsAre(0));
    const auto all = [](std::uint32_t) { return true; };
    EXPECT_THAT(Meshes(squares(1, 0.0f, heights), all).at(0.3f, 0.4f),
                UnorderedElementsAre(0, 1, 2, 3));
    const auto upper = [](std::uint32_t face) { return face < 2; };
    const auto met = Meshes(squares(1, 0.0f, heights), upper).at(0.3f, 0.4f);
    EXPECT_THAT(met, ::testing::IsSupersetOf({0u, 1u, 2u}));
    const auto close = Meshes(squares(2, 0.0f, heights), all).at(0.9998f, 0.4f);
    EXPECT_THAT(close, ::testing::IsSupersetOf({0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u}));
}

TEST(MeshRayStore, layers_are_what_a_ray_meets_on_its_way) {
    const auto layers = [](std::shared_ptr<Scene> scene) {
        Meshes mesh(std::move(scene));
        return mesh.store.layers(0, *mesh.shared);
    };
    // A square seen from anywhere: half of its area, of which its bounds show as much.
    EXPECT_DOUBLE_EQ(layers(squares(1, 0.0f, {0.0f})), 1.0);
    // A hundred of them within a cube: 100 squares show 50 square metres, the cube 1.5.
    std::vector<float> heights;
    for (int i = 0; i < 100; ++i) heights.push_back(static_cast<float>(i) / 99.0f);
    EXPECT_NEAR(layers(squares(1, 0.0f, heights)), 100.0 / 3.0, 1e-4);
}

TEST(MeshRays, one_mesh_serves_rays_that_end_and_rays_that_go_on) {
    auto kept = std::make_shared<PersistentRays>();
    const auto scene = squares(1, 0.0f, {1.0f, 0.0f});
    Report report;
    const Progress progress;
    GeometryCache cache;
    const auto shared = cache.shared(*scene, 0, report);
    MeshRayStore store(*scene, kept, progress), later(*scene, kept, progress);
    EXPECT_FALSE(store.was_there(0, false));
    const auto ends = store.mesh(0, shared, false).shape,
               goes_on = store.mesh(0, shared, true).shape;
    EXPECT_NE(ends, goes_on);  // Embree asks to be told that rays bring filters
    EXPECT_EQ(kept->made(), 2u);
    EXPECT_EQ(later.mesh(0, shared, true).shape, goes_on);
    EXPECT_THAT(later.mesh(0, shared, false).shape, ::testing::AnyOf(ends, goes_on));
    EXPECT_EQ(kept->made(), 2u);
    EXPECT_TRUE(MeshRayStore(*scene, kept, progress).was_there(0, true));
    // At another time of the shutter the same mesh may be cut into other triangles.
    scene->options.frame_time += 0.25f;
    EXPECT_FALSE(MeshRayStore(*scene, kept, progress).was_there(0, false));
}

}  // namespace
}  // namespace granita
