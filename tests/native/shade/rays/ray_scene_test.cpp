// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_scene.h"

#include <gtest/gtest.h>
#include <opensubdiv/bfr/surface.h>

#include <limits>

#include "base/error.h"
#include "geometry/corner_values.h"
#include "geometry/shared_geometry.h"
#include "geometry/subdivision_topology.h"
#include "math/sampling.h"
#include "shade/lights/light_scene.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
const Vec3f kUp(0, 0, 1);

GeometryData square(float half) {
    return quads("mesh 'Square'",
                 {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}});
}

/// A cube's cage, every face a quad.
GeometryData cube() {
    GeometryData data;
    data.name = "mesh 'Cube'";
    for (int i = 0; i < 8; ++i)
        data.points.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    data.corner_verts = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    data.face_sizes.assign(6, 4);
    return data;
}

/// Where the hit's patch and uv say that it is, object space: linear over the patch.
Vec3f object_position(const RayHit& hit) {
    const CornerValues corners =
        corner_values(*hit.geometry, *hit.patch, {AttributeSource::ObjectPosition, "", 3, false});
    const CornerWeights weights(hit.patch->kind, hit.uv);
    Vec3d p(0.0);
    for (std::size_t k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c)
            p[c] += weights.w[k] * corners.at[k][static_cast<std::size_t>(c)];
    return Vec3f(p);
}

TEST(RayScene, a_square_blocks_exactly_the_rays_through_it) {
    Scene scene = empty_scene();
    add_instance(scene, square(0.5f), at({2, 0, 1}));
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    // A lamp at height 2 above the square's centre doubles its shadow on the floor.
    const Vec3f lamp(2, 0, 2);
    const SobolPoints points(1);
    std::vector<Ray> rays_to_ask;
    std::vector<Vec3f> expected;
    for (std::uint32_t i = 0; i < 4096; ++i) {
        const Vec2f u = points(i) * 4.0f - 2.0f;
        const float edge = std::max(std::abs(u.x), std::abs(u.y)) - 1.0f;
        if (std::abs(edge) < 1e-5f) continue;
        const Vec3f p(2 + u.x, u.y, 0), d = lamp - p;
        rays_to_ask.push_back({p, glm::normalize(d), glm::length(d)});
        expected.emplace_back(edge < 0 ? 0.0f : 1.0f);
        EXPECT_EQ(rays.transmittance(rays_to_ask.back()), expected.back()) << u.x << " " << u.y;
    }
    // Many at once, also where they are no whole number of packets.
    for (const std::size_t count :
         {rays_to_ask.size(), std::size_t{37}, std::size_t{16}, std::size_t{1}}) {
        std::vector<Vec3f> left(count);
        rays.transmittances({rays_to_ask.data(), count}, left);
        EXPECT_TRUE(std::equal(left.begin(), left.end(), expected.begin()));
    }
    // What lies beyond the lamp casts no shadow.
    EXPECT_EQ(rays.transmittance({{2, 0, 0}, kUp, 0.9f}), Vec3f(1.0f));
    EXPECT_EQ(rays.transmittance({{2, 0, 0}, kUp, kInfinity}), Vec3f(0.0f));
    EXPECT_GT(rays.bytes(), 0u);
}

TEST(RayScene, rays_that_are_no_numbers_or_start_out_of_reach_meet_nothing) {
    Scene scene = empty_scene();
    add_instance(scene, square(1e3f), at({0, 0, 1}));
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Ray good{Vec3f(0.0f), kUp, kInfinity};
    std::vector<Ray> rays_to_ask;
    for (const float bad : {nan, kInfinity, -kInfinity, 1e19f, 1e30f})
        for (int axis = 0; axis < 3; ++axis) {
            rays_to_ask.push_back(good);
            rays_to_ask.emplace_back(good).start[axis] = bad;
            rays_to_ask.emplace_back(good).direction[axis] = bad;
        }
    rays_to_ask.emplace_back(good).distance = nan;
    rays_to_ask.emplace_back(good).time = nan;
    std::vector<Vec3f> left(rays_to_ask.size());
    rays.transmittances(rays_to_ask, left);
    for (std::size_t i = 0; i < rays_to_ask.size(); ++i) {
        const bool is_good = i < 45 && i % 3 == 0;
        EXPECT_EQ(left[i], Vec3f(is_good ? 0.0f : 1.0f)) << i;
        EXPECT_EQ(rays.transmittance(rays_to_ask[i]), left[i]) << i;
    }
}

TEST(RayScene, instances_that_cast_no_shadow_are_not_in_it) {
    Scene scene = empty_scene();
    scene.instances[add_instance(scene, square(1), at({0, 0, 1}))].casts_shadow = false;
    const Progress progress;
    scene.world.lights_scene = false;
    EXPECT_TRUE(RayScene(scene, Vec3d(0.0), {}, progress).empty());
    // But rays that diffuse lobes send to the world meet them.
    scene.world.lights_scene = true;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    Ray ray{{0.1f, 0.1f, 0.0f}, {0, 0, 1}, 2.0f};
    EXPECT_EQ(rays.transmittance(ray), Vec3f(1.0f));
    ray.type = RayType::Diffuse;
    EXPECT_EQ(rays.transmittance(ray), Vec3f(0.0f));
}

TEST(RayScene, stands_at_the_frame_time_between_knots) {
    Scene scene = empty_scene();
    Instance& moving = scene.instances[add_instance(scene, square(0.1f), at({0, 0, 1}))];
    moving.world_from_object = {at({-1, 0, 1}), at({3, 0, 1})};
    scene.options.frame_time = 0.5f;
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    EXPECT_EQ(rays.transmittance({{1, 0, 0}, kUp, kInfinity}), Vec3f(0.0f));
    EXPECT_EQ(rays.transmittance({{-1, 0, 0}, kUp, kInfinity}), Vec3f(1.0f));
    // Each ray of many has its own time: the square is at -1 + 4 t.
    std::vector<Ray> rays_to_ask;
    for (int i = 0; i <= 20; ++i)
        rays_to_ask.push_back(
            {{-1.0f + 0.2f * static_cast<float>(i), 0, 0}, kUp, kInfinity, 0.25f});
    std::vector<Vec3f> left(rays_to_ask.size());
    rays.transmittances(rays_to_ask, left);
    for (std::size_t i = 0; i < left.size(); ++i) EXPECT_EQ(left[i], Vec3f(i == 5 ? 0.0f : 1.0f));
    for (Ray& ray : rays_to_ask) ray.time = 0.25f * (ray.start.x + 1.0f);
    rays.transmittances(rays_to_ask, left);
    for (const Vec3f& passes : left) EXPECT_EQ(passes, Vec3f(0.0f));
}

TEST(RayScene, keeps_its_bits_far_from_the_worlds_origin) {
    const Vec3d far(1e6, -2e6, 3e6);
    Scene scene = empty_scene();
    add_instance(scene, square(0.5f), at(far + Vec3d(0, 0, 1)));
    const Progress progress;
    const RayScene rays(scene, far, {}, progress);
    EXPECT_EQ(rays.transmittance({{0.4999f, 0, 0}, kUp, kInfinity}), Vec3f(0.0f));
    EXPECT_EQ(rays.transmittance({{0.5001f, 0, 0}, kUp, kInfinity}), Vec3f(1.0f));
}

TEST(RayScene, lifted_points_of_a_limit_surface_do_not_shade_themselves) {
    // A cube's limit surface: points on it, from a finer evaluation than the ray scene's, are lit
    // from every direction above their tangent plane.
    GeometryData cage = cube();
    cage.is_subdivision = true;
    Scene scene = empty_scene();
    add_instance(scene, cage, at({0, 0, 0}));
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    Report report;
    const SharedGeometry shared(cage, 0.5f, report);
    int tested = 0;
    for (std::uint32_t face = 0; face < 6; ++face) {
        OpenSubdiv::Bfr::Surface<float> surface;
        ASSERT_TRUE(
            shared.subdivision()->factory().InitVertexSurface(static_cast<int>(face), &surface));
        std::vector<float> control(static_cast<std::size_t>(surface.GetNumPatchPoints()) * 3);
        surface.PreparePatchPoints(&cage.points[0].x, 3, control.data(), 3);
        const SobolPoints points(face);
        for (std::uint32_t i = 0; i < 200; ++i) {
            const Vec2f uv = points(i);
            Vec3f p, du, dv;
            surface.Evaluate(&uv.x, control.data(), 3, &p.x, &du.x, &dv.x);
            const Vec3f n = glm::normalize(glm::cross(du, dv));
            ASSERT_GT(glm::dot(n, p), 0.0f);
            const GridKey key{0, face, 1};
            const Vec3f start = rays.ray_offset(key)(p, n);
            EXPECT_LT(glm::length(start - p), 0.02f);  // the offset stays small
            const Vec3f local = sample_cone(points(i + 1000), 0.98f);
            EXPECT_EQ(rays.transmittance({start, Basis(n).to_world(local), kInfinity}),
                      Vec3f(1.0f));
            // And it is solid: looking inwards is dark.
            EXPECT_EQ(rays.transmittance({start, -n, kInfinity}), Vec3f(0.0f));
            ++tested;
        }
    }
    EXPECT_EQ(tested, 1200);
}

TEST(RayScene, points_of_scaled_and_bent_quads_do_not_shade_themselves_nor_start_far_off) {
    Scene scene = empty_scene();
    const GeometryData saddle =
        quads("mesh 'Saddle'", {{0, 0, 0.1f}, {1, 0, -0.1f}, {1, 1, 0.1f}, {0, 1, -0.1f}});
    Mat4d place = at({500, 0, 0});
    for (int axis = 0; axis < 3; ++axis) place[axis] *= 10.0;
    add_instance(scene, saddle, place);
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    const SobolPoints points(1);
    for (std::uint32_t i = 0; i < 500; ++i) {
        const Vec2f u = points(i);
        // Two triangles that meet in a ridge from the first corner to the third.
        const float z = 0.1f - 0.2f * std::abs(u.x - u.y), slope = u.x > u.y ? 0.2f : -0.2f;
        const Vec3f p(500 + 10 * u.x, 10 * u.y, 10 * z);
        const Vec3f n = glm::normalize(Vec3f(slope, -slope, 1.0f));
        const Vec3f start = rays.ray_offset({0, 0, 1})(p, n);
        EXPECT_LT(glm::distance(start, p), 0.01f);  // by rounding alone
        EXPECT_EQ(rays.transmittance({start, kUp, kInfinity}), Vec3f(1.0f));
    }
}

TEST(RayScene, flat_faces_of_any_shape_and_size_lift_by_rounding_alone) {
    // Neither a trapezoid nor a subdivided plane is linear in its parameters, yet both lie in their
    // triangles: lifted by that, a floor would lose the shadows of all that stands on it.
    const GeometryData trapezoid =
        quads("mesh 'Trapezoid'", {{-400, -400, 0}, {400, -400, 0}, {100, 400, 0}, {-100, 700, 0}});
    GeometryData subdivided = square(400);
    subdivided.is_subdivision = true;
    for (const GeometryData& floor : {trapezoid, subdivided}) {
        Scene scene = empty_scene();
        add_instance(scene, floor, at({0, 0, 0}));
        const Progress progress;
        const RayScene rays(scene, Vec3d(0.0), {}, progress);
        EXPECT_LT(rays.ray_offset({0, 0, 1})({10, 20, 0}, kUp).z, 0.01f) << floor.name;
        EXPECT_GT(rays.ray_offset({0, 0, 1})({10, 20, 0}, kUp).z, 0.0f) << floor.name;
    }
}

TEST(RayScene, transparent_materials_multiply_and_opaque_ones_end) {
    Scene scene = empty_scene();
    scene.materials.resize(2);
    for (int layer = 1; layer <= 3; ++layer)
        scene.instances[add_instance(scene, square(1), at({0, 0, layer}))].materials = {0};
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t material) { return material == 0; };
    opacity.transparency = [](const RayHit& hit, RayType) {
        // A cut-out: a hole where the first coordinate is positive, tinted glass elsewhere.
        EXPECT_EQ(hit.material, 0);
        EXPECT_NEAR(hit.normal.z, 1.0f, 1e-6f);
        const float x = object_position(hit).x;
        EXPECT_NEAR(x, hit.p.x, 1e-5f);
        return x > 0 ? Vec3f(1.0f) : Vec3f(0.5f, 0.25f, 1.0f);
    };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    EXPECT_EQ(rays.transmittance({{0.5f, 0.2f, 0}, kUp, kInfinity}), Vec3f(1.0f));
    EXPECT_EQ(rays.transmittance({{-0.5f, 0.2f, 0}, kUp, kInfinity}),
              Vec3f(0.125f, 0.015625f, 1.0f));
    EXPECT_EQ(rays.transmittance({{-0.5f, 0.2f, 0}, kUp, 2.5f}), Vec3f(0.25f, 0.0625f, 1.0f));

    scene.instances[1].materials = {1};
    const RayScene blocked(scene, Vec3d(0.0), opacity, progress);
    EXPECT_EQ(blocked.transmittance({{0.5f, 0.2f, 0}, kUp, kInfinity}), Vec3f(0.0f));
}

TEST(RayScene, rays_together_pass_what_each_passes_alone) {
    // Two layers of a half beside an opaque square; every fourth ray meets nothing.
    Scene scene = empty_scene();
    scene.materials.resize(2);
    for (const float z : {1.0f, 2.0f})
        scene.instances[add_instance(scene, square(0.4f), at({0, 0, z}))].materials = {0};
    scene.instances[add_instance(scene, square(0.4f), at({1, 0, 1}))].materials = {1};
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t material) { return material == 0; };
    opacity.transparency = [](const RayHit& hit, RayType) { return Vec3f(0.25f + 0.5f * hit.p.x); };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    std::vector<Ray> asked;
    for (int i = 0; i < 100; ++i)
        asked.push_back(
            {{i % 2 + 0.007f * static_cast<float>(i % 50) + (i % 4 == 3 ? 5.0f : 0.0f), 0.1f, 0},
             kUp,
             kInfinity});
    std::vector<Vec3f> left(asked.size());
    rays.transmittances(asked, left);
    for (std::size_t i = 0; i < asked.size(); ++i) {
        EXPECT_EQ(left[i], rays.transmittance(asked[i])) << i;
        const float layer = 0.25f + 0.5f * asked[i].start.x;
        const float expected = i % 4 == 3 ? 1.0f : i % 2 == 1 ? 0.0f : layer * layer;
        EXPECT_NEAR(left[i].x, expected, 1e-6f) << i;
    }
}

TEST(RayScene, places_are_not_looked_up_where_the_same_passes_everywhere) {
    Scene scene = empty_scene();
    scene.materials.resize(1);
    scene.instances[add_instance(scene, square(1), at({0, 0, 1}))].materials = {0, 0};
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t) { return true; };
    opacity.transparency = [](const RayHit&, RayType) -> Vec3f {
        throw SceneError("place", "asked");
    };
    opacity.constant = [](std::int32_t) { return Vec3f(0.5f, 0.25f, 1.0f); };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    EXPECT_EQ(rays.transmittance({{0.3f, 0.1f, 0}, kUp, kInfinity}), Vec3f(0.5f, 0.25f, 1.0f));
}

TEST(RayScene, casters_are_there_for_their_part_of_the_shutter) {
    // Two of one geometry that take turns at .37, one of them glass; and an opaque one below until
    // .1.
    Scene scene = empty_scene();
    scene.materials.resize(2);
    const std::size_t before = add_instance(scene, square(1), at({0, 0, 2}));
    scene.instances[before].lifespan = {0.0f, 0.37f};
    Instance after = scene.instances[before];
    after.lifespan = {0.37f, kInfinity};
    after.key = 7;
    after.materials = {0};
    scene.instances.push_back(after);
    scene.instances[add_instance(scene, square(1), at({0, 0, 1}))].lifespan = {0.0f, 0.1f};
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t material) { return material == 0; };
    opacity.transparency = [](const RayHit&, RayType) { return Vec3f(0.5f); };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    const auto left = [&](float time, float distance) {
        return rays.transmittance({{0.3f, 0.2f, 0}, kUp, distance, time});
    };
    const float last = std::nextafter(0.37f, 0.0f);
    for (const float time : {0.0f, 0.2f, last}) EXPECT_EQ(left(time, kInfinity), Vec3f(0.0f));
    for (const float time : {0.37f, 0.8f, 1.0f}) EXPECT_EQ(left(time, kInfinity), Vec3f(0.5f));
    EXPECT_EQ(left(0.05f, 1.5f), Vec3f(0.0f));
    EXPECT_EQ(left(0.1f, 1.5f), Vec3f(1.0f));
    // Still, but what passes depends on time where they are.
    EXPECT_TRUE(rays.moves());
    EXPECT_TRUE(rays.varies({0.3f, 0.2f, 0}, kUp, kInfinity));
    EXPECT_FALSE(rays.varies({5, 5, 0}, kUp, kInfinity));
}

TEST(RayScene, what_never_exists_casts_nothing) {
    Scene scene = empty_scene();
    scene.instances[add_instance(scene, square(1), at({0, 0, 1}))].lifespan = {0.4f, 0.4f};
    const Progress progress;
    EXPECT_TRUE(RayScene(scene, Vec3d(0.0), {}, progress).empty());
}

TEST(RayScene, hits_on_a_limit_surface_name_the_patch_and_the_place_on_it) {
    GeometryData cage = cube();
    cage.is_subdivision = true;
    cage.subdivision.scheme = SubdivisionScheme::Simple;  // stays the cube: corners are known
    Scene scene = empty_scene();
    scene.materials.resize(1);
    scene.instances[add_instance(scene, cage, at({0, 0, 0}))].materials = {0};
    std::vector<Vec3f> seen;
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t) { return true; };
    opacity.transparency = [&](const RayHit& hit, RayType) {
        const Vec3f p = object_position(hit);
        EXPECT_LT(glm::length(p - hit.p), 1e-4f);
        seen.push_back(p);
        return Vec3f(0.5f);
    };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    EXPECT_EQ(rays.transmittance({{0.33f, -0.71f, -3}, kUp, kInfinity}), Vec3f(0.25f));
    EXPECT_EQ(seen.size(), 2u);
}

TEST(RayScene, hits_on_what_moves_and_what_stands_still_of_a_mesh_name_their_faces) {
    // Four squares side by side, of which the first and the third go up within the shutter.
    GeometryData data;
    data.name = "mesh 'Row'";
    data.knots = 2;
    for (const float height : {0.0f, 4.0f})
        for (int f = 0; f < 4; ++f)
            for (const Vec2f& c : {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1)})
                data.points.emplace_back(c.x + 2.0f * static_cast<float>(f), c.y,
                                         f % 2 == 0 ? height : 0.0f);
    for (std::int32_t v = 0; v < 16; ++v) data.corner_verts.push_back(v);
    data.face_sizes.assign(4, 4);
    Scene scene = empty_scene();
    Mat4d upside_down = at({0, 0, 2});
    upside_down[1] *= -1.0;
    upside_down[2] *= -1.0;
    add_instance(scene, data, upside_down);

    std::uint32_t face = 9;
    float height = 0.0f;
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t) { return true; };
    opacity.transparency = [&](const RayHit& hit, RayType) {
        face = hit.patch->face;
        height = hit.p.z;
        EXPECT_EQ(hit.direction, -kUp);
        EXPECT_NEAR(hit.normal.z, -1.0f, 1e-6f);
        return Vec3f(0.5f);
    };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    for (std::uint32_t f = 0; f < 4; ++f)
        for (const float x : {0.3f, 0.7f}) {
            const Vec3f start(x + 2.0f * static_cast<float>(f), -0.5f, 9.0f);
            EXPECT_EQ(rays.transmittance({start, -kUp, kInfinity, 0.25f}), Vec3f(0.5f));
            EXPECT_EQ(face, f);
            EXPECT_NEAR(height, f % 2 == 0 ? 1.0f : 2.0f, 1e-5f);
        }
}

TEST(RayScene, an_error_inside_a_material_comes_out_of_the_ray) {
    Scene scene = empty_scene();
    scene.instances[add_instance(scene, square(1), at({0, 0, 1}))].materials = {0};
    scene.materials.resize(1);
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t) { return true; };
    opacity.transparency = [](const RayHit&, RayType) -> Vec3f {
        throw SceneError("material 'M'", "x");
    };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    EXPECT_THROW(rays.transmittance({{0, 0, 0}, kUp, kInfinity}), SceneError);
}

TEST(RayScene, stops_when_cancelled) {
    Scene scene = empty_scene();
    add_instance(scene, square(1), at({0, 0, 1}));
    Progress progress;
    progress.cancel();
    EXPECT_THROW(RayScene(scene, Vec3d(0.0), {}, progress), Cancelled);
}

TEST(RayScene, broken_faces_and_flat_transforms_neither_cast_nor_harm) {
    Scene scene = empty_scene();
    GeometryData broken = square(1);
    broken.points[2].x = std::numeric_limits<float>::quiet_NaN();
    add_instance(scene, broken, at({0, 0, 1}));
    Mat4d flat = at({0, 0, 1});
    flat[0] *= 0.0;
    add_instance(scene, square(1), flat);
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    EXPECT_EQ(rays.transmittance({{0, 0, 0}, kUp, kInfinity}), Vec3f(1.0f));
}

// Half a millimetre under a lid, on a mesh that goes on for ten kilometres.
/// Whose limit, where it is subdivided, is flat and holds what is asked of its faces.
void expect_contact_shadow_of_a_detail(bool is_subdivision) {
    Scene scene = empty_scene();
    GeometryData data = quads("mesh 'Land'", {{-1e4f, -1e4f, -50},
                                              {1e4f, -1e4f, -50},
                                              {1e4f, 1e4f, -50},
                                              {-1e4f, 1e4f, -50},
                                              {5, 5, 1},
                                              {6, 5, 1},
                                              {6, 6, 1},
                                              {5, 6, 1},
                                              {5, 5, 1.0005f},
                                              {6, 5, 1.0005f},
                                              {6, 6, 1.0005f},
                                              {5, 6, 1.0005f}});
    data.is_subdivision = is_subdivision;
    add_instance(scene, std::move(data), at({0, 0, 0}));
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), {}, progress);
    const SobolPoints points(3);
    for (std::uint32_t i = 0; i < 1024; ++i) {
        const Vec2f u = points(i);
        const Vec3f direction = glm::normalize(Vec3f(u.x - 0.5f, u.y - 0.5f, 1.0f));
        const Vec3f below(5.3f + 0.4f * u.y, 5.3f + 0.4f * u.x, 1.0f);
        const Vec3f start = rays.ray_offset({0, 1, 1})(below, kUp);
        EXPECT_EQ(rays.transmittance({start, direction, kInfinity}), Vec3f(0.0f));
        // Neither lid nor land shades itself.
        const Vec3f above = rays.ray_offset({0, 2, 1})(Vec3f(below.x, below.y, 1.0005f), kUp);
        EXPECT_EQ(rays.transmittance({above, direction, kInfinity}), Vec3f(1.0f));
        const Vec3f far_away(5000.0f * u.x + 100.0f, 5000.0f * u.y + 100.0f, -50.0f);
        const Vec3f land = rays.ray_offset({0, 0, 1})(far_away, kUp);
        EXPECT_EQ(rays.transmittance({land, direction, kInfinity}), Vec3f(1.0f));
    }
}

TEST(RayScene, a_small_detail_of_a_huge_mesh_keeps_its_contact_shadow) {
    expect_contact_shadow_of_a_detail(false);
}

TEST(RayScene, a_small_detail_of_a_huge_subdivided_mesh_keeps_its_contact_shadow) {
    expect_contact_shadow_of_a_detail(true);
}

}  // namespace
}  // namespace granita
