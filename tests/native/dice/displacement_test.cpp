// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases 50 and 53: displacement by constants, its bound, and tilings that stay closed.
#include <algorithm>
#include <cmath>

#include "dice/dice_scene.h"
#include "geometry/surface_frames.h"

namespace granita::testing {
namespace {

/// Along the normal by an amount a material; the last is of no material.
class ByMaterial final : public Displacement {
  public:
    ByMaterial(DiceScene& scene, std::vector<float> amounts, float bound)
        : m_scene(scene), m_amounts(std::move(amounts)), m_bound(bound) {
        scene.view.displacement = this;
        scene.view.requests.assign(m_amounts.size(), {});
    }
    bool displaces(std::size_t) const override { return true; }
    float bound(std::size_t) const override { return m_bound; }
    std::size_t same_as(std::size_t instance) const override { return instance; }
    void find(std::size_t index, const SharedGeometry& geometry,
              std::span<const SurfacePlace> places, bool derivatives, Offsets& out) const override {
        out.offset.clear();
        for (const SurfacePlace& place : places) {
            SurfaceFrames frames;
            find_frames(geometry, *place.patch, {&place.uv, 1}, geometry.frame(), frames);
            out.offset.push_back(amount(index, geometry, place.patch->face) *
                                 Vec3f(frames.normal[0]));
        }
        out.by_u.assign(derivatives ? places.size() : 0, Vec3f(0.0f));
        out.by_v.assign(derivatives ? places.size() : 0, Vec3f(0.0f));
    }

  private:
    float amount(std::size_t index, const SharedGeometry& geometry, std::uint32_t face) const {
        const auto& slots = m_scene.scene.instances[index].materials;
        const auto& of_faces = geometry.data().material_index;
        const int slot = of_faces.empty() ? 0 : of_faces[face];
        const int material = slots.empty() ? -1 : slots[static_cast<std::size_t>(slot)];
        return material < 0 ? m_amounts.back() : m_amounts[static_cast<std::size_t>(material)];
    }

    const DiceScene& m_scene;
    std::vector<float> m_amounts;
    float m_bound;
};

TEST(Displacement, a_displaced_plane_is_a_translated_plane) {
    for (const bool subdivided : {false, true}) {
        GeometryData data =
            mesh({{-40, -40, 9}, {-40, 40, 9}, {40, 40, 9}, {40, -40, 9}}, {4}, {0, 1, 2, 3});
        data.is_subdivision = subdivided;
        data.subdivision.boundary = SubdivisionBoundary::EdgeAndCorner;
        DiceScene flat(data), moved(data);
        const ByMaterial displaced(moved, {2.5f}, 2.5f);
        const auto a = flat.grids(), b = moved.grids();
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t g = 0; g < a.size(); ++g)
            for (std::size_t i = 0; i < a[g]->positions.size(); ++i) {
                // This winding looks back at the camera: outward is -z.
                const Vec3f expected = a[g]->positions[i] + 2.5f * a[g]->normal[i];
                EXPECT_NEAR(glm::distance(b[g]->positions[i], expected), 0.0f, 1e-5f);
                EXPECT_NEAR(std::abs(b[g]->positions[i].z - 9.0f), 2.5f, 1e-5f);
                // Two slopes that cancel leave what the rounding of one is.
                EXPECT_NEAR(glm::distance(a[g]->normal[i], b[g]->normal[i]), 0.0f, 1e-7f);
            }
        EXPECT_TRUE(moved.report.warnings().empty());
    }
}

TEST(Displacement, closed_surfaces_stay_closed) {
    for (const int kind : {0, 1, 2})
        for (const float rate : {1.0f, 7.0f}) {
            GeometryData data = cube(20.0f);
            if (kind == 1) data.smooth.assign(6, 1);
            data.is_subdivision = kind == 2;
            data.material_index = {0, 1, 0, 1, 2, 0};
            DiceScene s(data, rate, 64);
            s.scene.instances[0].materials = {0, 1, -1};
            s.scene.materials.resize(2);
            // Three materials that move by different amounts meet at every corner.
            const ByMaterial displaced(s, {3.0f, -1.0f, 0.0f}, 3.0f);
            Mat4d turn(1.0);
            turn[0] = glm::dvec4(0.8, 0.6, 0, 0);
            turn[1] = glm::dvec4(-0.6, 0.8, 0, 0);
            s.scene.instances[0].world_from_object = {turn, turn * Mat4d(1.5)};
            s.scene.instances[0].world_from_object[1][3][3] = 1.0;
            const auto grids = s.grids();
            for (const int knot : {0, 1})
                EXPECT_TRUE(open_edges(grids, knot).empty()) << kind << " " << rate;
        }
}

TEST(Displacement, bounds_grow_by_the_bound) {
    for (const bool subdivided : {false, true}) {
        GeometryData data = cube(20.0f);
        data.is_subdivision = subdivided;
        DiceScene s(data);
        const ByMaterial displaced(s, {4.0f}, 4.0f);
        const RasterBounds whole = instance_bounds(s.view, 0);
        const auto opened = open_instance(s.view, 0, s.report);
        for (std::size_t i = 0; i < opened->primitive_count(); ++i) {
            const RasterBounds out = opened->bounds(i);
            std::vector<std::unique_ptr<Grid>> grids;
            DiceScene::dice_all(*opened->primitive(i), grids);
            for (const auto& grid : grids)
                for (const RasterBounds& said : {out, whole}) expect_within(grid->bounds, said);
        }
        EXPECT_TRUE(s.report.warnings().empty());
    }
}

}  // namespace
}  // namespace granita::testing
