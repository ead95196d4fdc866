// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of a pixel or less share grids: the same micropolygons, fewer points.  Faces of a few
// pixels share them too: the same micropolygons and points.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "dice/opened_mesh.h"
#include "dice/patch.h"
#include "dice_scene.h"
#include "geometry/surface_frames.h"

namespace granita::testing {
namespace {

/// n x n quads over `size` metres around the origin, z from `height(x, y)`.
template <class Height>
GeometryData sheet(int n, float size, Height height) {
    std::vector<Vec3f> p;
    std::vector<std::int32_t> corners;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const float x = size * (static_cast<float>(i) / n - 0.5f);
            const float y = size * (static_cast<float>(j) / n - 0.5f);
            p.emplace_back(x, y, height(x, y));
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int v = j * (n + 1) + i;
            for (const int c : {v, v + 1, v + n + 2, v + n + 1}) corners.push_back(c);
        }
    return mesh(std::move(p), std::vector<std::int32_t>(static_cast<std::size_t>(n) * n, 4),
                std::move(corners));
}

GeometryData flat_sheet(int n, float size) {
    return sheet(n, size, [](float, float) { return 5.0f; });
}

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
    GeometryData data = mesh({}, {}, {});
    constexpr int n = 48;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i < 2 * n; ++i) {
            const double latitude = M_PI * (static_cast<double>(j) / n - 0.5);
            const double longitude = M_PI * i / n;
            const double r = 40.0 + 35.0 * std::sin(longitude);
            data.points.emplace_back(r * std::cos(latitude) * std::cos(longitude),
                                     r * std::cos(latitude) * std::sin(longitude),
                                     r * std::sin(latitude) + 300.0);
            if (j == 0 || j == n) data.points.back() = {0.0f, 0.0f, j == 0 ? 260.0f : 340.0f};
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < 2 * n; ++i) {
            const int a = j * 2 * n + i, b = j * 2 * n + (i + 1) % (2 * n);
            for (const int c : {a, b, b + 2 * n, a + 2 * n}) data.corner_verts.push_back(c);
            data.face_sizes.push_back(4);
        }
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

/// Up, by a function of where a point is before, at any knot.
class Raised final : public Displacement {
  public:
    using Height = std::function<float(const Vec3d&)>;
    Raised(DiceScene& scene, Height height) : m_height(std::move(height)) {
        scene.view.displacement = this;
        scene.view.requests.assign(1, {});
    }
    bool displaces(std::size_t) const override { return true; }
    float bound(std::size_t) const override { return 50.0f; }
    std::size_t same_as(std::size_t instance) const override { return instance; }
    void find(std::size_t, const SharedGeometry& geometry, std::span<const SurfacePlace> places,
              bool derivatives, Offsets& out) const override {
        constexpr double kStep = 1e-4;
        out = {};
        for (const SurfacePlace& place : places) {
            const std::vector<Vec2d> uv{place.uv, place.uv + Vec2d(kStep, 0.0),
                                        place.uv + Vec2d(0.0, kStep)};
            SurfaceFrames at;
            find_frames(geometry, *place.patch, uv, geometry.frame(), at);
            const auto up = [&](std::size_t i) { return Vec3f(0.0f, 0.0f, m_height(at.p[i])); };
            out.offset.push_back(up(0));
            if (!derivatives) continue;
            out.by_u.push_back((up(1) - up(0)) / static_cast<float>(kStep));
            out.by_v.push_back((up(2) - up(0)) / static_cast<float>(kStep));
        }
    }

  private:
    Height m_height;
};

TEST(SmallFaces, displaced_ones_share_grids_too) {
    const auto waves = [](const Vec3d& p) {
        return static_cast<float>(2.0 * std::sin(0.3 * p.x) * std::cos(0.2 * p.y));
    };
    for (const bool subdivided : {false, true})
        for (const bool moves : {false, true}) {
            GeometryData data = flat_sheet(48, 48.0f);
            data.is_subdivision = subdivided;
            data.subdivision.boundary = SubdivisionBoundary::EdgeAndCorner;
            DiceScene s(data);
            const Raised raised(s, waves);
            s.scene.materials.resize(1);
            s.scene.instances[0].materials = {0};
            s.view.requests = {{{AttributeSource::ObjectPosition, "", 3, false}}};
            if (moves) {
                Mat4d up(1.0);
                up[3].z = 3.0;
                s.scene.instances[0].world_from_object = {Mat4d(1.0), up};
            }
            const auto grids = s.grids();
            EXPECT_LT(grids.size(), 32u) << subdivided;
            EXPECT_EQ(micropolygons(grids), 48 * 48);
            for (const auto& grid : grids) {
                ASSERT_TRUE(grid->disjoint);
                for (std::size_t i = 0; i < grid->positions.size(); ++i) {
                    const auto k = static_cast<int>(i) / grid->vertex_count();
                    const Vec3f& p = grid->positions[i];
                    EXPECT_NEAR(p.z, 5.0f + waves(Vec3d(p)) + 3.0f * static_cast<float>(k), 1e-5f);
                }
                for (std::size_t i = 0; i < grid->point_count(); ++i) {
                    const Vec3f& p = grid->shading_p()[i];
                    const double x = p.x, y = p.y;
                    const Vec3d up(-0.6 * std::cos(0.3 * x) * std::cos(0.2 * y),
                                   0.4 * std::sin(0.3 * x) * std::sin(0.2 * y), 1.0);
                    // Of a chord, where the slope is: half a metre by a curvature of .18 at most.
                    EXPECT_NEAR(std::abs(glm::dot(grid->normal[i], Vec3f(glm::normalize(up)))),
                                1.0f, 2e-3f);
                    const Vec3f way(0.0f, 0.0f, moves ? 3.0f * s.scene.options.frame_time : 0.0f);
                    const float* const in_object = &grid->attributes[0].values[3 * i];
                    // The mean of four corners; the point lies between two of them.
                    EXPECT_NEAR(
                        glm::distance(Vec3f(in_object[0], in_object[1], in_object[2]), p - way),
                        0.0f, 0.05f);
                }
            }
        }
}

/// What a grid is shaded with at a vertex.
struct Shaded {
    Vec3f normal, geometric_normal, position;
};

TEST(SmallFaces, displaced_ones_are_what_their_patches_would_be) {
    using Place = std::array<float, 3>;
    // Of a micropolygon each, of two by two and of four by four; triangles and bent quads.
    for (const float size : {20.0f, 40.0f, 80.0f})
        for (const bool bent : {false, true}) {
            GeometryData data = sheet(24, size, [&](float x, float y) {
                return bent ? std::sin(x * 0.4f) * std::sin(y * 0.4f) : 0.01f * (x - y);
            });
            data.smooth.assign(24 * 24, 1);
            DiceScene s(data);
            const Raised raised(s, [&](const Vec3d& p) {
                return static_cast<float>(0.2 * std::sin(0.5 * p.x + p.y));
            });
            s.scene.materials.resize(1);
            s.scene.instances[0].materials = {0};
            s.view.requests = {{{AttributeSource::ObjectPosition, "", 3, true}}};
            const auto opened =
                std::dynamic_pointer_cast<const OpenedMesh>(open_instance(s.view, 0, s.report));
            ASSERT_TRUE(opened);
            const auto places_of = [](const std::vector<std::unique_ptr<Grid>>& grids) {
                std::map<Place, std::vector<Shaded>> out;
                for (const auto& grid : grids)
                    for (std::size_t v = 0; v < grid->positions.size(); ++v) {
                        const std::size_t i = grid->point_at(v);
                        const Vec3f& p = grid->positions[v];
                        const float* const at = &grid->attributes[0].values[3 * i];
                        out[{p.x, p.y, p.z}].push_back(
                            {grid->normal[i], grid->geometric_normal[i], {at[0], at[1], at[2]}});
                    }
                return out;
            };
            const auto batched = s.grids();
            EXPECT_LT(batched.size(), size < 30.0f ? 20u : size < 60.0f ? 50u : 120u) << size;
            std::vector<std::unique_ptr<Grid>> single;
            for (const BasePatch& patch : opened->shared().patches())
                DiceScene::dice_all(*Patch::open(opened, patch), single);
            const auto a = places_of(batched), b = places_of(single);
            ASSERT_EQ(a.size(), b.size());
            // A bent quad of a micropolygon is one, and is two patches elsewhere.
            const bool whole = size < 30.0f;  // normals of chords, places of a point a pixel
            for (auto at = a.begin(), to = b.begin(); at != a.end(); ++at, ++to) {
                ASSERT_EQ(at->first, to->first);
                // A face on either side of an edge has a normal of its own.
                for (const Shaded& is : at->second)
                    EXPECT_TRUE(std::ranges::any_of(to->second, [&](const Shaded& should_be) {
                        const float least = whole ? 0.9f : 0.9998f;  // it curves by .4 a metre
                        return glm::dot(is.normal, should_be.normal) > least &&
                               glm::dot(is.geometric_normal, should_be.geometric_normal) > least &&
                               glm::distance(is.position, should_be.position) <
                                   (whole ? 2.0f : 1e-5f);
                    }));
            }
            EXPECT_EQ(open_edges(batched).size(), open_edges(single).size());
        }
}

TEST(SmallFaces, what_displacement_stretches_is_not_shaded_as_one_point) {
    for (const bool subdivided : {false, true}) {
        GeometryData data = flat_sheet(32, 32.0f);
        data.is_subdivision = subdivided;
        data.subdivision.boundary = SubdivisionBoundary::EdgeAndCorner;
        DiceScene s(std::move(data));
        s.perspective();
        s.view.projection.scale = {5.0, 5.0};  // a pixel at five metres
        // A cliff: the faces across it are seen from the side, many pixels long.
        const Raised raised(s, [](const Vec3d& p) { return p.x > 10.3 ? -1.0f : 0.0f; });
        const auto grids = s.grids();
        int stretched = 0;
        for (const auto& grid : grids) {
            EXPECT_TRUE(grid->disjoint);
            if (!grid->shades_faces()) stretched += grid->micropolygon_count();
        }
        EXPECT_EQ(stretched, 32);
        EXPECT_LT(grids.size(), 32u);
        EXPECT_EQ(micropolygons(grids), 1024);
    }
}

}  // namespace
}  // namespace granita::testing
