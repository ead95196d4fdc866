// SPDX-License-Identifier: GPL-3.0-or-later
// Which faces rays name of a mesh in its own space.
#include "shade/rays/mesh_rays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
          rays(store.shape(0, shared, passes != nullptr), *shared, passes) {}
    std::vector<std::uint32_t> at(float x, float y) const {
        std::vector<std::uint32_t> patches;
        MeshRays::Work work;
        rays.meet({{x, y, 10.0f}, {0.0f, 0.0f, -1.0f}, INFINITY}, patches, work);
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

/// There rays are rounded by more than a thousandth of a face.
TEST(MeshRays, far_from_the_origin_close_is_farther) {
    constexpr float kFar = 60000.0f;
    const Meshes mesh(squares(3, kFar, {0.0f}));
    EXPECT_THAT(mesh.at(kFar + 1.03125f, 0.4f), ElementsAre(1, 0));
    EXPECT_THAT(mesh.at(kFar + 1.3125f, 0.4f), ElementsAre(1));
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

TEST(MeshRays, one_mesh_serves_rays_that_end_and_rays_that_go_on) {
    auto kept = std::make_shared<KeptRays>();
    const auto scene = squares(1, 0.0f, {1.0f, 0.0f});
    Report report;
    const Progress progress;
    GeometryCache cache;
    const auto shared = cache.shared(*scene, 0, report);
    MeshRayStore store(*scene, kept, progress), later(*scene, kept, progress);
    const auto ends = store.shape(0, shared, false), goes_on = store.shape(0, shared, true);
    EXPECT_NE(ends, goes_on);  // Embree asks to be told that rays bring filters
    EXPECT_EQ(kept->made(), 2u);
    EXPECT_EQ(later.shape(0, shared, true), goes_on);
    EXPECT_THAT(later.shape(0, shared, false), ::testing::AnyOf(ends, goes_on));
    EXPECT_EQ(kept->made(), 2u);
}

}  // namespace
}  // namespace granita
