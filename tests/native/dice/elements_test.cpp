// SPDX-License-Identifier: GPL-3.0-or-later
// Curves as ribbons and points as spheres (docs/hard_cases.md, cases 9, 27 and 57).
#include <numeric>
#include <random>
#include <set>

#include "dice/dice_scene.h"
#include "dice/raster_bound.h"

namespace granita::testing {
namespace {

/// Curves of one radius, one knot.
GeometryData curves(const std::vector<std::vector<Vec3f>>& list, float radius) {
    GeometryData data;
    data.name = "curves 'Test'";
    data.kind = GeometryKind::Curves;
    for (const auto& curve : list) {
        data.points.insert(data.points.end(), curve.begin(), curve.end());
        data.curve_sizes.push_back(static_cast<std::int32_t>(curve.size()));
    }
    data.radius.assign(data.points.size(), radius);
    return data;
}

GeometryData cloud(std::vector<Vec3f> points, float radius) {
    GeometryData data;
    data.name = "points 'Test'";
    data.kind = GeometryKind::Points;
    data.points = std::move(points);
    data.radius.assign(data.points.size(), radius);
    return data;
}

double open_length(const std::vector<std::unique_ptr<Grid>>& grids) {
    double sum = 0.0;
    for (const auto& [a, b] : open_edges(grids)) sum += glm::distance(Vec3d(a), Vec3d(b));
    return sum;
}

/// Area in the raster at a knot, pixels^2; every micropolygon counts with the same sign.
double raster_area(const View& view, const std::vector<std::unique_ptr<Grid>>& grids) {
    const auto project = [&](const Vec3f& p) {
        const Vec3f h = view.projection.homogeneous(p, Vec2d(0.0));
        return Vec2d(h.x, h.y) / static_cast<double>(h.z);
    };
    double sum = 0.0;
    for (const auto& grid : grids)
        for (int m = 0; m < grid->micropolygon_count(); ++m) {
            const Grid::Corners c = grid->corners(m);
            const Vec2d a = project(grid->positions[c.v0]), b = project(grid->positions[c.v1]);
            const Vec2d d = project(grid->positions[c.v2]), e = project(grid->positions[c.v3]);
            sum += 0.5 * ((d.x - a.x) * (e.y - b.y) - (d.y - a.y) * (e.x - b.x));
        }
    return std::abs(sum);
}

void expect_finite(const std::vector<std::unique_ptr<Grid>>& grids) {
    for (const auto& grid : grids)
        for (const auto* list :
             {&grid->positions, &grid->normal, &grid->geometric_normal, &grid->dp_du, &grid->dp_dv})
            for (const Vec3f& v : *list) EXPECT_TRUE(is_finite(v));
}

class Ribbon : public ::testing::TestWithParam<float> {};

TEST_P(Ribbon, of_a_straight_curve_has_its_length_times_its_width) {
    const float radius = GetParam();
    DiceScene scene(curves({{{-60, -20, 5}, {-20, -10, 5}, {20, 0, 5}, {60, 10, 5}}}, radius));
    const auto grids = scene.grids();
    const double length = std::hypot(120.0, 30.0);
    EXPECT_NEAR(area(grids) / (2.0 * radius * length), 1.0,
                1e-5 + 4e-6 / radius);  // float positions at 60 m
    // Pieces share their rows bit for bit: nothing is open but the outline.
    EXPECT_NEAR(open_length(grids), 2.0 * length + 4.0 * radius, 1e-3);
    for (const auto& grid : grids) EXPECT_LE(grid->micropolygon_count(), 256);
}
INSTANTIATE_TEST_SUITE_P(Widths, Ribbon, ::testing::Values(0.001f, 0.1f, 0.5f, 4.0f, 30.0f));

TEST(Curve, is_split_without_cracks) {
    std::vector<Vec3f> spiral;
    for (int i = 0; i <= 40; ++i) {
        const float angle = 0.4f * static_cast<float>(i), r = 20.0f + 2.0f * static_cast<float>(i);
        spiral.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0f);
    }
    DiceScene scene(curves({spiral}, 3.0f), 1.0f, 32);
    const auto grids = scene.grids();
    EXPECT_GT(grids.size(), 50u);
    // A ribbon's two sides are together as long as its curve twice, whatever its bends.
    double length = 0.0;  // of the curve, over 1000 chords a segment of its own formula
    const auto at = [&](int i) { return Vec3d(spiral[static_cast<std::size_t>(i)]); };
    Vec3d last = at(0);
    for (int i = 0; i < 40; ++i)
        for (int s = 1; s <= 1000; ++s) {
            const double t = s / 1000.0;
            const Vec3d a = at(std::max(i - 1, 0)), b = at(i), c = at(i + 1);
            const Vec3d d = at(std::min(i + 2, 40));
            const Vec3d p =
                0.5 * (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t +
                       (3.0 * b - a - 3.0 * c + d) * t * t * t);
            length += glm::distance(last, p);
            last = p;
        }
    EXPECT_NEAR(open_length(grids) / (2.0 * length + 12.0), 1.0, 2e-3);
    EXPECT_NEAR(area(grids) / (6.0 * length), 1.0, 2e-3);
}

TEST(Curves, that_are_neighbours_share_a_grid) {
    std::vector<std::vector<Vec3f>> hairs;
    for (int i = 0; i < 24; ++i) {
        const auto x = static_cast<float>(i);
        hairs.push_back({{x, 0, 0}, {x, 3, 0}, {x, 6, 0}});
    }
    DiceScene scene(curves(hairs, 0.25f));
    const auto opened = open_instance(scene.view, 0, scene.report);
    EXPECT_EQ(opened->primitive_count(), 1u);
    const auto grids = scene.grids();
    EXPECT_EQ(grids.size(), 1u);
    EXPECT_NEAR(area(grids), 24 * 6.0 * 0.5, 1e-4);
    EXPECT_NEAR(open_length(grids), 24 * (12.0 + 1.0), 1e-3);
}

TEST(Curves, that_lie_side_by_side_are_cut_together) {
    // Long ones: a bucket meets pieces of many, not each of them by itself.
    std::vector<std::vector<Vec3f>> hairs;
    double length = 0.0;
    for (int i = 0; i < 24; ++i) {
        const auto x = static_cast<float>(i);
        hairs.push_back({{x, -150, 0}, {x, -50, 0}, {x, 50, 0}, {x, 150, 0}});
        length += 300.0;
    }
    DiceScene scene(curves(hairs, 0.25f));
    const auto grids = scene.grids();
    EXPECT_NEAR(area(grids), length * 0.5, 1e-2);
    // Pieces share their rows bit for bit: nothing is open but the outlines.
    EXPECT_NEAR(open_length(grids), 2.0 * length + 24 * 1.0, 1e-2);
    EXPECT_GE(static_cast<double>(micropolygons(grids)) / static_cast<double>(grids.size()), 64.0);
    std::set<GridKey> keys;
    for (const auto& grid : grids) {
        EXPECT_TRUE(keys.insert(grid->key).second);
        EXPECT_LE(grid->bounds.x1 - grid->bounds.x0, 64.0f);
        EXPECT_LE(grid->bounds.y1 - grid->bounds.y0, 64.0f);
    }
}

TEST(Curves, smaller_than_a_pixel_take_one_step) {
    std::vector<Vec3f> hair;
    for (int i = 0; i <= 8; ++i) hair.emplace_back(0.0f, 0.1f * static_cast<float>(i), 0.0f);
    DiceScene scene(curves({hair}, 0.01f));
    EXPECT_EQ(micropolygons(scene.grids()), 1);
}

TEST(Curves, narrower_than_a_pixel_have_long_micropolygons) {
    for (const auto& [width, longest] :
         {std::pair(0.9f, 1.0), {0.4f, 2.0}, {0.2f, 4.0}, {0.01f, 4.0}}) {
        DiceScene scene(curves({{{-50, 0, 0}, {50, 0, 0}}}, 0.5f * width));
        const double length = 100.0 / micropolygons(scene.grids());
        EXPECT_LE(length, M_SQRT2 * longest);
        EXPECT_GT(length, M_SQRT1_2 * longest);
    }
    // What bends keeps its shape.
    std::vector<Vec3f> circle;
    for (int i = 0; i <= 32; ++i) {
        const double angle = 2.0 * M_PI * i / 32;
        circle.emplace_back(5.0 * std::cos(angle), 5.0 * std::sin(angle), 0.0);
    }
    DiceScene scene(curves({circle}, 0.1f));
    const double length = 10.0 * M_PI / micropolygons(scene.grids());
    EXPECT_LE(length * length / (8.0 * 5.0), 0.03);  // the sag of a chord
}

TEST(Curves, that_close_to_a_tip) {
    GeometryData data = curves({{{0, -50, 0}, {0, 50, 0}}}, 4.0f);
    data.radius = {4.0f, 0.0f};
    DiceScene scene(std::move(data));
    const auto grids = scene.grids();
    // Between two points the radius goes linearly and a little faster: -s(1 - s)(1 - 2s) / 2 of
    // the difference on top, which adds nothing to the area.
    EXPECT_NEAR(area(grids), 100.0 * 8.0 / 2.0, 0.05);
    expect_finite(grids);
}

TEST(Curves, that_degenerate_stay_finite) {
    const std::vector<std::vector<Vec3f>> list = {
        {{0, 0, 5}, {0, 0, 5}, {0, 0, 5}},                              // a point
        {{0, 0, 5}, {10, 0, 50}, {10, 0, 50}, {10, 0, 50}, {0, 0, 5}},  // a cusp
        {{0, 0, 1}, {0, 0, 2}, {0, 0, 90}},                             // to the eye
        {{0, 0, -3}, {0.01f, 0, 0}, {0, 0, 3}},                         // through it
        {{0, 0, 0}, {1, 1, 1}},                                         // from it
    };
    DiceScene scene(curves(list, 0.5f));
    scene.perspective();
    const auto grids = scene.grids();
    EXPECT_FALSE(grids.empty());
    expect_finite(grids);
}

TEST(Curves, around_the_eye_end) {
    // The eye inside a tube that goes on for a kilometre.
    std::vector<Vec3f> tube;
    for (int i = -10; i <= 10; ++i) tube.emplace_back(0.1f, -0.2f, 100.0f * static_cast<float>(i));
    DiceScene scene(curves({tube}, 1.0f));
    scene.perspective();
    const auto grids = scene.grids();
    expect_finite(grids);
    EXPECT_GT(grids.size(), 0u);
    EXPECT_LT(micropolygons(grids), 200000);
}

TEST(Elements, that_cannot_be_rendered_are_named) {
    GeometryData data = curves(
        {{{0, 0, 0}, {1, 0, 0}}, {{NAN, 0, 0}, {1, 1, 0}}, {{5, 5, 0}}, {{0, 2, 0}, {1, 2, 0}}},
        0.5f);
    data.radius[5] = data.radius[6] = -1.0f;
    DiceScene scene(std::move(data));
    EXPECT_NEAR(area(scene.grids()), 1.0, 1e-5);
    std::vector<std::string> messages;
    for (const auto& warning : scene.report.warnings()) {
        EXPECT_EQ(warning.datablock, "curves 'Test'");
        messages.push_back(warning.message);
    }
    std::sort(messages.begin(), messages.end());
    EXPECT_EQ(messages,
              (std::vector<std::string>{
                  "1 curve of a single point left out", "1 curve with non-finite values left out",
                  "1 curve without any radius left out", "has negative radii, taken as 0"}));
}

class Disc : public ::testing::TestWithParam<float> {};

TEST_P(Disc, of_a_point_has_its_area) {
    const float radius = GetParam();
    DiceScene scene(cloud({{3.3f, -7.1f, 4.0f}}, radius));
    const auto grids = scene.grids();
    EXPECT_NEAR(raster_area(scene.view, grids) / (M_PI * radius * radius), 1.0,
                1e-4 + 4e-6 / radius);  // float positions at 7 m
    expect_finite(grids);
}
INSTANTIATE_TEST_SUITE_P(Radii, Disc, ::testing::Values(0.01f, 0.2f, 0.5f, 3.0f, 40.0f));

TEST(Sphere, has_the_outline_that_the_eye_sees) {
    // On the axis at distance d: a disc of radius f r / sqrt(d^2 - r^2).
    DiceScene scene(cloud({{0, 0, 5}}, 2.0f));
    scene.perspective(100.0);
    const auto grids = scene.grids();
    EXPECT_NEAR(raster_area(scene.view, grids) / (M_PI * 1e4 * 4.0 / 21.0), 1.0, 2e-4);
    for (const auto& grid : grids)
        for (std::size_t i = 0; i < grid->normal.size(); ++i) {
            // Facing the eye, and on the sphere (its outline's corners a little outside).
            EXPECT_LT(glm::dot(grid->normal[i], glm::normalize(grid->positions[i])), 1e-3f);
            EXPECT_NEAR(glm::distance(grid->positions[i], Vec3f(0, 0, 5)), 2.0f, 0.01f);
        }
}

TEST(Sphere, around_the_eye_is_not_seen) {
    DiceScene scene(cloud({{0, 0, 1}}, 2.0f));
    scene.perspective(100.0);
    const auto grids = scene.grids();
    expect_finite(grids);
    for (const auto& grid : grids)
        for (const Vec3f& p : grid->positions) EXPECT_EQ(p, Vec3f(0, 0, 1));
}

TEST(Points, that_are_neighbours_share_a_grid) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 25; ++i)
        points.emplace_back(static_cast<float>(i % 5), static_cast<float>(i / 5), 0.0f);
    DiceScene scene(cloud(points, 0.4f));
    const auto grids = scene.grids();
    EXPECT_EQ(grids.size(), 1u);
    EXPECT_NEAR(raster_area(scene.view, grids) / (25 * M_PI * 0.16), 1.0, 1e-4);
}

/// Random moving elements: whatever is diced lies within the bounds of what it was split from.
void expect_bounds_to_hold(GeometryData data) {
    data.knots = 3;
    const std::size_t n = data.points.size();
    std::mt19937 random(7);
    std::uniform_real_distribution<float> shift(-20.0f, 20.0f);
    for (std::size_t i = 0; i < 2 * n; ++i)
        data.points.push_back(data.points[i] + Vec3f(shift(random), shift(random), shift(random)));
    DiceScene scene(std::move(data));
    scene.perspective();
    scene.view.projection.lens_radius = 0.3;
    const RasterBounds whole = instance_bounds(scene.view, 0);
    const auto opened = open_instance(scene.view, 0, scene.report);
    const auto holds = [](const RasterBounds& outer, const RasterBounds& inner) {
        if (!inner.visible) return true;
        // A bound is rounded outwards twice: once for each of the two.
        return outer.visible && outer.x0 <= inner.x0 + 0.01f && outer.x1 >= inner.x1 - 0.01f &&
               outer.y0 <= inner.y0 + 0.01f && outer.y1 >= inner.y1 - 0.01f &&
               outer.nearest_key >= inner.nearest_key * (1.0f - 1e-5f);
    };
    int diced = 0;
    const std::function<void(const Primitive&)> visit = [&](const Primitive& primitive) {
        if (primitive.diceable()) {
            ++diced;
            EXPECT_TRUE(holds(primitive.bounds(), primitive.dice()->bounds));
            return;
        }
        const auto children = primitive.split();
        EXPECT_GE(children.size(), 2u);
        for (const auto& child : children) visit(*child);
    };
    for (std::size_t i = 0; i < opened->primitive_count(); ++i) {
        EXPECT_TRUE(holds(whole, opened->bounds(i)));
        visit(*opened->primitive(i));
    }
    EXPECT_GT(diced, 20);
}

TEST(Elements, lie_within_their_bounds) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(-80.0f, 80.0f), depth(50.0f, 300.0f);
    const auto anywhere = [&] { return Vec3f(place(random), place(random), depth(random)); };
    std::vector<std::vector<Vec3f>> list(40);
    for (auto& curve : list)
        for (int i = 0; i < 5; ++i) curve.push_back(anywhere());
    expect_bounds_to_hold(curves(list, 0.7f));
    std::vector<Vec3f> points;
    for (int i = 0; i < 200; ++i) points.push_back(anywhere());
    expect_bounds_to_hold(cloud(points, 15.0f));
}

TEST(Curves, keep_their_materials_apart) {
    GeometryData data = curves({{{0, 0, 0}, {5, 0, 0}}, {{0, 1, 0}, {5, 1, 0}}}, 0.25f);
    data.material_index = {1, 0};
    DiceScene scene(std::move(data));
    scene.scene.materials.resize(2);
    scene.scene.instances[0].materials = {0, 1};
    scene.view.requests.resize(3);
    for (const auto& grid : scene.grids())
        EXPECT_EQ(grid->material, grid->positions[0].y < 0.5f ? 1 : 0);
    EXPECT_EQ(scene.grids().size(), 2u);
}

TEST(Curves, carry_their_attributes) {
    GeometryData data =
        curves({{{0, 0, 0}, {20, 0, 0}, {40, 0, 0}, {60, 0, 0}}, {{0, 40, 0}, {60, 40, 0}}}, 0.25f);
    data.attributes.push_back(
        {"along", Domain::Point, AttributeKind::Generic, 1, {0, 20, 40, 60, 2, 2}});
    data.attributes.push_back({"root", Domain::Face, AttributeKind::Uv, 2, {0, 0, 0.5f, 1}});
    DiceScene scene(std::move(data));
    scene.view.requests = {{{AttributeSource::Named, "along", 1, true},
                            {AttributeSource::DefaultUv, "", 3, false},
                            {AttributeSource::Generated, "", 3, false}}};
    for (const auto& grid : scene.grids())
        for (std::size_t i = 0; i < grid->positions.size(); ++i) {
            const bool second = grid->positions[i].y > 20.0f;
            const float x = grid->positions[i].x;
            // Points of equal distance: between its inner ones a curve goes evenly.
            if (second || (x >= 20.0f && x <= 40.0f)) {
                EXPECT_NEAR(grid->attributes[0].values[i], second ? 2.0f : x, 1e-4f);
            }
            EXPECT_EQ(grid->attributes[1].values[3 * i], second ? 0.5f : 0.0f);
            EXPECT_EQ(grid->attributes[1].values[3 * i + 1], second ? 1.0f : 0.0f);
            EXPECT_EQ(grid->attributes[2].values[3 * i + 1], second ? 1.0f : 0.0f);
        }
}

}  // namespace
}  // namespace granita::testing
