// SPDX-License-Identifier: GPL-3.0-or-later
// A small frame in which buckets share everything, and its picture.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "render/render_job.h"

namespace granita {

/// Pixels a side: the thread sanitizer takes twenty to fifty times as long.
inline constexpr int kSize = 48;

inline Node node(const std::string& type) {
    Node out;
    out.type = type;
    return out;
}

inline Material diffuse() {
    Material material;
    material.name = "Diffuse";
    material.graph.nodes = {node("ShaderNodeBsdfDiffuse")};
    material.graph.nodes[0].inputs["Color"] = Vec4f(0.8f, 0.5f, 0.3f, 1.0f);
    material.graph.surface = {0, "BSDF"};
    return material;
}

/// Diffuse and clear in a pattern of noise, so that opacity runs before visibility.
inline Material lace() {
    Material material = diffuse();
    material.name = "Lace";
    auto& nodes = material.graph.nodes;
    nodes.push_back(node("ShaderNodeBsdfTransparent"));
    nodes[1].inputs["Color"] = Vec4f(1.0f);
    nodes.push_back(node("ShaderNodeTexNoise"));
    nodes[2].inputs["Scale"] = Vec4f(0.2f);
    nodes.push_back(node("ShaderNodeMixShader"));
    nodes[3].inputs["Fac"] = NodeLink{2, "Fac"};
    nodes[3].inputs["Shader"] = NodeLink{1, "BSDF"};
    nodes[3].inputs["Shader_001"] = NodeLink{0, "BSDF"};
    material.graph.surface = {3, "Shader"};
    return material;
}

/// A sheet of n x n bumpy quads over the frame, at depth z.
inline GeometryData sheet(int n, float z) {
    GeometryData data;
    data.name = "mesh 'Sheet'";
    const auto count = static_cast<float>(n);
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            data.points.emplace_back(
                kSize * (1.2f * static_cast<float>(i) / count - 0.1f),
                kSize * (1.2f * static_cast<float>(j) / count - 0.1f),
                z + 2.0f * std::sin(static_cast<float>(i)) * std::cos(static_cast<float>(j)));
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            for (const int v : {j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1,
                                (j + 1) * (n + 1) + i})
                data.corner_verts.push_back(v);
    data.face_sizes.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 4);
    data.smooth.assign(data.face_sizes.size(), 1);
    return data;
}

inline GeometryData box(const Vec3f& low, const Vec3f& high) {
    GeometryData data;
    data.name = "mesh 'Box'";
    for (int i = 0; i < 8; ++i)
        data.points.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y,
                                 i & 4 ? high.z : low.z);
    data.corner_verts = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    data.face_sizes.assign(6, 4);
    data.smooth.assign(6, 0);
    return data;
}

inline GeometryData hair(int count) {
    GeometryData data;
    data.name = "curves 'Hair'";
    data.kind = GeometryKind::Curves;
    for (int i = 0; i < count; ++i) {
        const auto x = static_cast<float>(i * 37 % kSize), y = static_cast<float>(i * 53 % kSize);
        for (int k = 0; k < 4; ++k) {
            const auto t = static_cast<float>(k);
            data.points.emplace_back(x + 4.0f * t, y + 2.0f * t * t, 40.0f - t);
            data.radius.push_back(0.5f);
        }
    }
    data.curve_sizes.assign(static_cast<std::size_t>(count), 4);
    return data;
}

inline void add(Scene& scene, GeometryData data, std::int32_t material, const Vec3d& motion) {
    Instance instance;
    instance.name = data.name;
    instance.geometry = static_cast<int>(scene.geometries.size());
    instance.key = static_cast<std::uint32_t>(scene.instances.size());
    instance.materials = {material};
    instance.world_from_object = {Mat4d(1.0)};
    if (motion != Vec3d(0.0)) {
        Mat4d end(1.0);
        end[3] = glm::dvec4(motion, 1.0);
        instance.world_from_object.push_back(end);
    }
    scene.geometries.push_back(std::move(data));
    scene.instances.push_back(instance);
}

/// Buckets that share everything: a few large faces, many small ones, a subdivision surface, hair,
/// things that move and that light passes through, a sun with shadows.
inline std::shared_ptr<Scene> make_scene(int threads) {
    auto scene = std::make_shared<Scene>();
    Options& o = scene->options;
    o.width = o.height = kSize;
    o.crop = {0, 0, kSize, kSize};
    o.bucket_size = 16;
    o.samples = 4;
    o.light_samples = 2;
    o.threads = threads;
    o.device = Device::Cpu;
    o.depth_pass = true;
    o.passes = {"Normal"};
    scene->camera.world_from_camera = {Mat4d(1.0)};
    Projection& p = scene->camera.projection;
    p.perspective = false;
    p.scale = {1.0, 1.0};
    p.near_clip = 0.01;
    p.far_clip = 1000.0;
    scene->materials = {diffuse(), lace()};
    add(*scene, sheet(2, 90.0f), 0, Vec3d(0.0));
    add(*scene, sheet(30, 70.0f), 1, Vec3d(5.0, 3.0, 0.0));
    GeometryData smooth = sheet(6, 50.0f);
    smooth.is_subdivision = true;
    add(*scene, std::move(smooth), 1, Vec3d(0.0));
    add(*scene, hair(40), 0, Vec3d(3.0, 0.0, 0.0));
    Light sun;
    sun.name = "Sun";
    sun.kind = LightKind::Sun;
    sun.energy = 3.0f;
    sun.sun_angle = 0.2f;
    Mat4d away(1.0);
    away[1].y = away[2].z = -1.0;
    sun.world_from_light = {away};
    scene->lights = {sun};
    return scene;
}

/// What a texture, bounced light and a medium share besides.
inline std::shared_ptr<Scene> make_lit_scene(int threads) {
    auto scene = make_scene(threads);
    Options& o = scene->options;
    o.light_samples = 1;
    o.depth_pass = false;  // media are in none, which is said
    o.passes.clear();
    o.bounces.most = 2;
    o.bounces.diffuse = 2;
    o.bounces.volume = 1;
    Image image;
    image.name = "Noise";
    image.width = image.height = 256;
    for (int i = 0; i < 256 * 256 * 4; ++i)
        image.pixels.push_back(static_cast<float>(i * 37 % 101) / 101.0f);
    scene->images = {image};
    Material printed = diffuse();
    printed.name = "Printed";
    auto& nodes = printed.graph.nodes;
    nodes = {node("ShaderNodeTexCoord"), node("ShaderNodeTexImage"), node("ShaderNodeBsdfDiffuse")};
    nodes[1].properties["image"] = image.name;
    nodes[1].inputs["Vector"] = NodeLink{0, "Generated"};
    nodes[2].inputs["Color"] = NodeLink{1, "Color"};
    printed.graph.surface = {2, "BSDF"};
    Material fog;
    fog.name = "Fog";
    fog.graph.nodes = {node("ShaderNodeVolumeScatter")};
    fog.graph.nodes[0].inputs["Color"] = Vec4f(0.7f);
    fog.graph.nodes[0].inputs["Density"] = Vec4f(0.02f);
    fog.graph.volume = {0, "Volume"};
    scene->materials.push_back(printed);
    scene->materials.push_back(fog);
    scene->instances[0].materials = {2};
    add(*scene, box({5.0f, 5.0f, 20.0f}, {30.0f, 40.0f, 45.0f}), 3, Vec3d(0.0));
    return scene;
}

struct Picture {
    std::vector<Vec4f> combined = std::vector<Vec4f>(kSize * kSize);
    std::vector<Warning> warnings;
    std::uint64_t pieces_shared = 0;
    std::uint64_t peak_list_bytes = 0;
};

/// `session`: whose scene it is, or none.
inline Picture render(const std::shared_ptr<Scene>& scene,
                      const std::shared_ptr<Session>& session = nullptr) {
    Picture picture;
    RenderJob job(scene, kHardware, session);
    while (!job.done())
        for (const Tile& tile : job.take_tiles(0.1)) {
            EXPECT_FALSE(job.device().empty());
            for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
                std::memcpy(&picture.combined[static_cast<std::size_t>(kSize * y + tile.rect.x0)],
                            &tile.combined[static_cast<std::size_t>((y - tile.rect.y0) *
                                                                    tile.rect.width())],
                            static_cast<std::size_t>(tile.rect.width()) * sizeof(Vec4f));
        }
    job.finish();
    picture.warnings = job.report().warnings();
    picture.pieces_shared = job.statistics().get(Counter::LoopPiecesShared);
    picture.peak_list_bytes = job.statistics().peak_list_bytes();
    return picture;
}

inline bool equal(const Picture& a, const Picture& b) {
    return std::memcmp(a.combined.data(), b.combined.data(), kSize * kSize * sizeof(Vec4f)) == 0;
}

}  // namespace granita
