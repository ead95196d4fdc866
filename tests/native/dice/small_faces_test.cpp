// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of a pixel or less share grids: the same micropolygons, fewer points.  Faces of a few
// pixels share them too: the same micropolygons and points.
#include <gtest/gtest.h>

#include <set>

#include "dice/opened_mesh.h"
#include "dice/patch.h"
#include "dice_scene.h"

namespace granita::testing {
namespace {

std::size_t points(const std::vector<std::unique_ptr<Grid>>& grids) {
    std::size_t sum = 0;
    for (const auto& grid : grids) sum += grid->point_count();
    return sum;
}

TEST(SmallFaces, every_face_is_one_micropolygon_with_the_bits_of_its_vertices) {
    DiceScene s(flat_sheet(32, 32.0f));
    const auto grids = s.grids();
    EXPECT_LT(grids.size(), 16u);
    EXPECT_EQ(micropolygons(grids), 1024);
    std::set<std::array<float, 2>> corners;
    for (const auto& grid : grids) {
        EXPECT_LE(grid->micropolygon_count(), 256);
        for (int m = 0; m < grid->micropolygon_count(); ++m) {
            const Grid::Corners c = grid->corners(m);
            const auto at = [&](int v) { return grid->positions[static_cast<std::size_t>(v)]; };
            corners.insert({at(c.v0).x, at(c.v0).y});
            EXPECT_EQ(at(c.v1), at(c.v0) + Vec3f(1, 0, 0));
            EXPECT_EQ(at(c.v2), at(c.v0) + Vec3f(1, 1, 0));
            EXPECT_EQ(at(c.v3), at(c.v0) + Vec3f(0, 1, 0));
        }
    }
    EXPECT_EQ(corners.size(), 1024u);
}

TEST(SmallFaces, their_borders_to_larger_faces_have_no_cracks) {
    // A closed surface: a ball's latitudes and longitudes, drawn out to one side.
    GeometryData data = globe(48, [](double latitude, double longitude) {
        if (std::abs(latitude) == 0.5 * M_PI) return Vec3f(0, 0, latitude < 0.0 ? 260 : 340);
        const double r = 40.0 + 35.0 * std::sin(longitude);
        return Vec3f(r * std::cos(latitude) * std::cos(longitude),
                     r * std::cos(latitude) * std::sin(longitude), r * std::sin(latitude) + 300.0);
    });
    DiceScene s(std::move(data));
    // All of them are of a few pixels at most; some are larger.
    for (const double focal : {250.0, 800.0}) {
        s.perspective(focal);
        const auto grids = s.grids();
        const auto apart = std::count_if(grids.begin(), grids.end(),
                                         [](const auto& grid) { return grid->disjoint; });
        EXPECT_GT(apart, 5);
        EXPECT_EQ(apart == static_cast<long>(grids.size()), focal == 250.0);
        EXPECT_TRUE(open_edges(grids).empty());
    }
}

using Corner = std::array<float, 6>;  ///< place and the normal it is shaded with

/// Of all micropolygons, sorted: their corners in order.
std::vector<std::array<Corner, 4>> shaded_corners(const std::vector<std::unique_ptr<Grid>>& grids) {
    std::vector<std::array<Corner, 4>> found;
    for (const auto& grid : grids)
        for (int m = 0; m < grid->micropolygon_count(); ++m) {
            const Grid::Corners c = grid->corners(m);
            found.emplace_back();
            for (std::size_t i = 0; const int vertex : {c.v0, c.v1, c.v2, c.v3}) {
                const auto v = static_cast<std::size_t>(vertex);
                const std::size_t point = grid->disjoint ? grid->shading_positions.point_of[v] : v;
                EXPECT_EQ(grid->shading_p()[point], grid->positions[v]);
                const Vec3f &p = grid->positions[v], &n = grid->normal[point];
                found.back()[i++] = {p.x, p.y, p.z, n.x, n.y, n.z};
            }
        }
    std::sort(found.begin(), found.end());
    return found;
}

TEST(SmallFaces, faces_of_a_few_pixels_share_grids_and_keep_their_micropolygons_and_points) {
    const auto wave = [](float x, float y) { return 50.0f + std::sin(0.3f * x) + 0.02f * x * y; };
    DiceScene shared(sheet(24, 72.0f, wave));
    DiceScene single(sheet(24, 72.0f, wave));
    const auto opened = open_instance(single.view, 0, single.report);
    const auto& mesh = dynamic_cast<const OpenedMesh&>(*opened);
    std::vector<std::unique_ptr<Grid>> alone;
    for (const BasePatch& patch : mesh.shared().patches())
        DiceScene::dice_all(*Patch::open(mesh.shared_from_this(), patch), alone);
    const auto grids = shared.grids();
    EXPECT_EQ(alone.size(), 576u);
    EXPECT_LT(grids.size(), 100u);
    for (const auto& grid : grids) EXPECT_LE(grid->micropolygon_count(), 256);
    EXPECT_EQ(shaded_corners(grids), shaded_corners(alone));
}

TEST(SmallFaces, points_follow_the_picture_and_not_the_mesh) {
    // 32 x 32 pixels of .35 to .125 pixel a face.
    for (const int n : {90, 128, 256}) {
        DiceScene s(flat_sheet(n, 32.0f));
        const auto grids = s.grids();
        EXPECT_EQ(micropolygons(grids), static_cast<long>(n) * n);
        EXPECT_GE(points(grids), 1024u) << n;
        EXPECT_LE(points(grids), 2048u) << n;
    }
    DiceScene coarse(flat_sheet(128, 32.0f));
    coarse.scene.options.shading_rate = 4.0f;
    EXPECT_LE(points(coarse.grids()), 128u);
}

TEST(SmallFaces, a_point_lies_on_a_face_of_its_colour) {
    DiceScene s(flat_sheet(100, 32.0f));
    for (const auto& grid : s.grids()) {
        ASSERT_EQ(grid->p.size(), grid->point_count());
        ASSERT_EQ(grid->shading_positions.point_of.size(),
                  static_cast<std::size_t>(grid->vertex_count()));
        for (std::size_t i = 0; i < grid->point_count(); ++i) {
            const std::uint32_t anchor = grid->shading_positions.anchors[i];
            const auto face = anchor % static_cast<std::uint32_t>(grid->n_u);
            EXPECT_EQ(grid->shading_positions.point_of[face], i);
            const Grid::Corners c = grid->corners(static_cast<int>(face));
            const auto at = [&](int v) { return grid->positions[static_cast<std::size_t>(v)]; };
            EXPECT_FLOAT_EQ(grid->p[i].z, 5.0f);
            EXPECT_LT(glm::distance(grid->p[i], 0.5f * (at(c.v0) + at(c.v2))), 1.0f);
            EXPECT_EQ(grid->normal[i], grid->geometric_normal[i]);
            EXPECT_FLOAT_EQ(std::abs(grid->geometric_normal[i].z), 1.0f);
        }
        // Colours go no further than the shading rate and a face.
        for (int m = 0; m < grid->micropolygon_count(); ++m) {
            const Vec3f& point =
                grid->p[grid->shading_positions.point_of[static_cast<std::size_t>(m)]];
            const Vec3f& corner = grid->positions[static_cast<std::size_t>(m)];
            EXPECT_LT(std::max(std::abs(point.x - corner.x), std::abs(point.y - corner.y)), 2.0f);
        }
    }
}

TEST(SmallFaces, what_faces_away_is_apart_from_what_is_seen) {
    // Two sheets in each other's place, one turned over.
    GeometryData data = flat_sheet(64, 32.0f);
    const std::size_t corners = data.corner_verts.size();
    for (std::size_t i = 0; i < corners; i += 4)
        for (const std::size_t c : {3, 2, 1, 0})
            data.corner_verts.push_back(data.corner_verts[i + c]);
    data.face_sizes.resize(2 * data.face_sizes.size(), 4);
    DiceScene s(std::move(data));
    for (const auto& grid : s.grids())
        for (const Vec3f& n : grid->geometric_normal)
            EXPECT_EQ(n.z > 0.0f, grid->geometric_normal[0].z > 0.0f);
}

// Two sharp sides of a roof of tiny faces: no point stands for both.
TEST(SmallFaces, a_crease_is_not_rounded) {
    DiceScene s(sheet(128, 32.0f, [](float x, float) { return 5.0f + std::abs(x); }));
    for (const auto& grid : s.grids())
        for (const Vec3f& n : grid->normal) EXPECT_NEAR(std::abs(n.x), M_SQRT1_2, 1e-3);
}

TEST(SmallFaces, keys_differ) {
    DiceScene s(flat_sheet(64, 64.0f));
    std::set<GridKey> keys;
    const auto grids = s.grids();
    for (const auto& grid : grids) keys.insert(grid->key);
    EXPECT_EQ(keys.size(), grids.size());
}

TEST(SmallFaces, averages_what_lies_within_a_point_and_looks_textures_up_at_one_place) {
    GeometryData data = flat_sheet(256, 32.0f);
    Attribute stripes{"stripes", Domain::Face, AttributeKind::Generic, 1, {}};
    for (std::size_t f = 0; f < data.face_sizes.size(); ++f)
        stripes.values.push_back(static_cast<float>((f + f / 256) % 2));
    data.attributes.push_back(stripes);
    DiceScene s(std::move(data));
    AttributeRequest mean, lookup;
    mean.name = lookup.name = "stripes";
    mean.width = lookup.width = 1;
    lookup.derivatives = true;
    s.view.requests = {{mean, lookup}};
    double error = 0.0;
    std::size_t count = 0;
    for (const auto& grid : s.grids()) {
        for (const float value : grid->attributes[0].values) error += std::abs(value - 0.5);
        count += grid->attributes[0].values.size();
        for (const float value : grid->attributes[1].values)
            EXPECT_TRUE(value == 0.0f || value == 1.0f);
    }
    EXPECT_LT(error / static_cast<double>(count), 0.05);
}

TEST(SmallFaces, hold_positions_alone_until_they_are_shaded) {
    for (const float size : {24.0f, 96.0f}) {
        DiceScene s(flat_sheet(32, size));
        const auto opened = open_instance(s.view, 0, s.report);
        for (std::size_t i = 0; i < opened->primitive_count(); ++i) {
            const auto grid = opened->primitive(i)->dice();
            ASSERT_TRUE(grid->disjoint);
            EXPECT_TRUE(grid->bounds.visible);
            EXPECT_EQ(grid->bytes(), sizeof(Grid) + sizeof(Vec3f) * grid->positions.size());
            ASSERT_TRUE(grid->shading_state);
            grid->shading_state(*grid);
            EXPECT_EQ(grid->p.size(), grid->point_count());
            EXPECT_EQ(grid->normal.size(), grid->point_count());
            EXPECT_EQ(grid->shading_positions.point_of.size(),
                      static_cast<std::size_t>(grid->vertex_count()));
        }
    }
}

}  // namespace
}  // namespace granita::testing
