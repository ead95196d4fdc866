// SPDX-License-Identifier: GPL-3.0-or-later
// Displaced faces of a pixel or a few share grids: the micropolygons that their patches would be.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "dice/opened_mesh.h"
#include "dice/patch.h"
#include "dice_scene.h"
#include "geometry/surface_frames.h"

namespace granita::testing {
namespace {

/// Up, by a function of where a point is before, at any knot.
class Raised final : public Displacement {
  public:
    using Height = std::function<float(const Vec3d&)>;
    Raised(DiceScene& scene, Height height, float bound = 50.0f)
        : m_height(std::move(height)), m_bound(bound) {
        scene.view.displacement = this;
        scene.view.requests.assign(1, {});
    }
    bool displaces(std::size_t) const override { return true; }
    float bound(std::size_t) const override { return m_bound; }
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
    float m_bound;
};

TEST(DisplacedFaces, share_grids_too) {
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

TEST(DisplacedFaces, are_what_their_patches_would_be) {
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

TEST(DisplacedFaces, what_is_stretched_is_not_shaded_as_one_point) {
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

TEST(DisplacedFaces, lie_within_the_bounds_of_their_batches) {
    // Spikes of two metres between the vertices too; bent quads have a point on their crease.
    const auto spikes = [](const Vec3d& p) {
        return static_cast<float>(2.0 * std::sin(9.0 * p.x) * std::sin(11.0 * p.y));
    };
    for (const float size : {20.0f, 30.0f, 45.0f, 80.0f})
        for (const bool subdivided : {false, true})
            for (const bool wide : {false, true}) {
                // Every second vertex is raised: quads with a crease.
                GeometryData data = sheet(24, size, [&](float x, float y) {
                    const float k = static_cast<float>(M_PI) * 24.0f / size;
                    return 9.0f + 0.3f * std::cos(k * x) * std::cos(k * y);
                });
                data.is_subdivision = subdivided;
                data.subdivision.boundary = SubdivisionBoundary::EdgeAndCorner;
                DiceScene s(std::move(data));
                if (wide) {
                    s.perspective();
                    s.view.projection.scale = {9.0, 9.0};
                }
                const Raised raised(s, spikes, 2.0f);
                const auto opened = open_instance(s.view, 0, s.report);
                std::size_t diced = 0;
                for (std::size_t i = 0; i < opened->primitive_count(); ++i) {
                    const RasterBounds said = opened->bounds(i);
                    std::vector<std::unique_ptr<Grid>> grids;
                    DiceScene::dice_all(*opened->primitive(i), grids);
                    for (const auto& grid : grids) {
                        ++diced;
                        expect_within(grid->bounds, said);
                    }
                }
                EXPECT_GT(diced, 0u);
            }
}

TEST(DisplacedFaces, have_no_cracks_to_what_is_larger_at_any_rate) {
    // A ball that is drawn out towards the eye: faces of all sizes, seen end-on too.
    for (const float rate : {1.0f, 8.0f})
        for (const float shading : {0.0f, 12.0f})
            for (const bool subdivided : {false, true}) {
                GeometryData data = globe(16, [](double latitude, double longitude) {
                    const bool pole = std::abs(latitude) == 0.5 * M_PI;
                    const double r = pole ? 0.0 : std::cos(latitude);
                    return Vec3f(0.3 + r * std::cos(longitude), r * std::sin(longitude) - 0.2,
                                 4.0 + 3.0 * std::sin(latitude));
                });
                data.is_subdivision = subdivided;
                DiceScene s(std::move(data), rate);
                s.scene.options.shading_rate = shading;
                s.perspective(120.0);
                const Raised raised(
                    s,
                    [](const Vec3d& p) {
                        return static_cast<float>(0.05 * std::sin(40.0 * p.x + 30.0 * p.y));
                    },
                    0.05f);
                const auto all = s.grids();
                std::vector<std::unique_ptr<Grid>> again;
                const auto opened =
                    std::dynamic_pointer_cast<const OpenedMesh>(open_instance(s.view, 0, s.report));
                for (const BasePatch& patch : opened->shared().patches())
                    DiceScene::dice_all(*Patch::open(opened, patch), again);
                // What lies outside the frame is left out of both alike: no more edges are open.
                EXPECT_EQ(open_edges(all).size(), open_edges(again).size())
                    << rate << " " << shading << " " << subdivided;
            }
}

TEST(DisplacedFaces, what_is_rough_is_diced_more_finely_and_stays_closed) {
    for (const bool subdivided : {false, true}) {
        std::vector<int> counts;
        for (const int samples : {4, 64, 256}) {
            GeometryData data = cube(20.0f, 60.0f);
            data.is_subdivision = subdivided;
            DiceScene s(data);
            s.scene.options.samples = samples;
            // One half of it is rough, so that edges differ and faces lie between them.
            const Raised raised(s, [](const Vec3d& p) {
                return static_cast<float>(p.x > 0.0 ? std::sin(3.0 * p.x) * std::sin(2.5 * p.y)
                                                    : 0.1 * std::sin(0.1 * p.y));
            });
            const auto grids = s.grids();
            EXPECT_TRUE(open_edges(grids).empty()) << subdivided << " " << samples;
            counts.push_back(micropolygons(grids));
        }
        // More than half of it, as grids take what their roughest edge needs.
        EXPECT_GT(counts[1], 2 * counts[0]) << subdivided;
        EXPECT_GT(counts[2], 2 * counts[1]) << subdivided;
        EXPECT_LT(counts[2], 16 * counts[0]) << subdivided;
    }
}

}  // namespace
}  // namespace granita::testing
