// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes for dicing tests, and what can be said of all grids of one instance.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "dice/open_instance.h"

namespace granita::testing {

/// A scene with one instance of one geometry; camera at the origin looking along z.
struct DiceScene {
    Scene scene;
    View view;
    Report report;
    Statistics statistics;

    explicit DiceScene(GeometryData geometry, float rate = 1.0f, int grid_size = 256) {
        scene.options.width = scene.options.height = 256;
        scene.options.dicing_rate = rate;
        scene.options.grid_size = grid_size;
        scene.camera.world_from_camera = {Mat4d(1.0)};
        scene.geometries.push_back(std::move(geometry));
        Instance instance;
        instance.name = "object 'Test'";
        instance.world_from_object = {Mat4d(1.0)};
        scene.instances.push_back(instance);
        view.scene = &scene;
        view.statistics = &statistics;
        orthographic();
    }
    DiceScene(const DiceScene&) = delete;
    DiceScene& operator=(const DiceScene&) = delete;

    /// One pixel a metre, the origin in the middle of the frame.
    void orthographic() {
        view.projection = {};
        view.projection.perspective = false;
        view.projection.scale = {1.0, 1.0};
        view.projection.center = {128.0, 128.0};
        view.projection.near_clip = -1e6;
        view.projection.far_clip = 1e6;
    }
    void perspective(double pixels = 256.0) {
        view.projection = {};
        view.projection.scale = {pixels, pixels};
        view.projection.center = {128.0, 128.0};
        view.projection.near_clip = 0.1;
        view.projection.far_clip = 1e7;
    }

    std::vector<std::unique_ptr<Grid>> grids(std::size_t instance = 0) {
        std::vector<std::unique_ptr<Grid>> grids;
        const auto opened = open_instance(view, instance, report);
        for (std::size_t i = 0; i < opened->primitive_count(); ++i) {
            if (!opened->bounds(i).visible) continue;
            dice_all(*opened->primitive(i), grids);
        }
        return grids;
    }
    static void dice_all(const Primitive& primitive, std::vector<std::unique_ptr<Grid>>& grids) {
        if (!primitive.bounds().visible) return;
        if (primitive.diceable()) {
            grids.push_back(primitive.dice());
            Grid* const grid = grids.back().get();
            if (grid && grid->shading_state) grid->shading_state(*grid);
            return;
        }
        for (const auto& child : primitive.split()) dice_all(*child, grids);
    }
};

inline GeometryData mesh(std::vector<Vec3f> points, std::vector<std::int32_t> sizes,
                         std::vector<std::int32_t> corners) {
    GeometryData data;
    data.name = "mesh 'Test'";
    data.points = std::move(points);
    data.face_sizes = std::move(sizes);
    data.corner_verts = std::move(corners);
    return data;
}

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

inline GeometryData flat_sheet(int n, float size) {
    return sheet(n, size, [](float, float) { return 5.0f; });
}

/// Corners at +-half, six outward quads.
inline GeometryData cube(float half, float z = 0.0f) {
    std::vector<Vec3f> p;
    for (int i = 0; i < 8; ++i)
        p.emplace_back(i & 1 ? half : -half, i & 2 ? half : -half, z + (i & 4 ? half : -half));
    return mesh(p, {4, 4, 4, 4, 4, 4},
                {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5});
}

/// Longitudes and latitudes of a closed surface, n rows of 2 n quads: `place(latitude, longitude)`,
/// the same all along a pole.
template <class Place>
GeometryData globe(int n, Place place) {
    GeometryData data = mesh({}, {}, {});
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i < 2 * n; ++i)
            data.points.emplace_back(
                place(M_PI * (static_cast<double>(j) / n - 0.5), M_PI * i / n));
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < 2 * n; ++i) {
            const int a = j * 2 * n + i, b = j * 2 * n + (i + 1) % (2 * n);
            for (const int c : {a, b, b + 2 * n, a + 2 * n}) data.corner_verts.push_back(c);
            data.face_sizes.push_back(4);
        }
    return data;
}

/// Whether a grid lies where what it is of was said to.
inline void expect_within(const RasterBounds& is, const RasterBounds& said) {
    EXPECT_GE(is.x0, said.x0 - 0.01f);
    EXPECT_LE(is.x1, said.x1 + 0.01f);
    EXPECT_GE(is.y0, said.y0 - 0.01f);
    EXPECT_LE(is.y1, said.y1 + 0.01f);
    EXPECT_LE(is.nearest_key, said.nearest_key + 0.01f);
}

inline double area(const std::vector<std::unique_ptr<Grid>>& grids, int knot = 0) {
    double sum = 0.0;
    for (const auto& grid : grids) {
        const Vec3f* p = &grid->positions[static_cast<std::size_t>(knot * grid->vertex_count())];
        for (int m = 0; m < grid->micropolygon_count(); ++m) {
            const Grid::Corners c = grid->corners(m);
            const Vec3d a(p[c.v0]);
            sum += 0.5 * glm::length(glm::cross(Vec3d(p[c.v1]) - a, Vec3d(p[c.v2]) - a)) +
                   0.5 * glm::length(glm::cross(Vec3d(p[c.v2]) - a, Vec3d(p[c.v3]) - a));
        }
    }
    return sum;
}

/// Directed edges of all micropolygon triangles that no equal and opposite edge closes, compared
/// bit by bit at a knot.  0 for a closed surface without cracks; its border otherwise.
inline std::vector<std::array<Vec3f, 2>> open_edges(const std::vector<std::unique_ptr<Grid>>& grids,
                                                    int knot = 0) {
    using Point = std::array<float, 3>;
    std::map<std::pair<Point, Point>, int> balance;
    const auto add = [&](const Vec3f& a, const Vec3f& b) {
        const Point p{a.x + 0.0f, a.y + 0.0f, a.z + 0.0f}, q{b.x + 0.0f, b.y + 0.0f, b.z + 0.0f};
        if (p == q) return;
        if (p < q)
            ++balance[{p, q}];
        else
            --balance[{q, p}];
    };
    for (const auto& grid : grids) {
        const int k = grid->knots > 1 ? knot : 0;
        const Vec3f* p = &grid->positions[static_cast<std::size_t>(k * grid->vertex_count())];
        for (int m = 0; m < grid->micropolygon_count(); ++m) {
            const Grid::Corners c = grid->corners(m);
            for (const auto& t : {std::array{c.v0, c.v1, c.v2}, std::array{c.v0, c.v2, c.v3}})
                for (int i = 0; i < 3; ++i)
                    add(p[t[static_cast<std::size_t>(i)]],
                        p[t[static_cast<std::size_t>((i + 1) % 3)]]);
        }
    }
    std::vector<std::array<Vec3f, 2>> open;
    for (const auto& [edge, count] : balance)
        if (count != 0) {
            const auto& [a, b] = edge;
            open.push_back({Vec3f(a[0], a[1], a[2]), Vec3f(b[0], b[1], b[2])});
        }
    return open;
}

inline long micropolygons(const std::vector<std::unique_ptr<Grid>>& grids) {
    long sum = 0;
    for (const auto& grid : grids) sum += grid->micropolygon_count();
    return sum;
}

}  // namespace granita::testing
