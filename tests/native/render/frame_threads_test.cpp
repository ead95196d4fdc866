// SPDX-License-Identifier: GPL-3.0-or-later
// Whole frames on several threads: what they share is found by the thread sanitizer, if by anybody
// (`./dev test --sanitize thread`); without it these are tests of equality.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "no_new_threads.h"
#include "render/render_job.h"

namespace granita {
namespace {

constexpr int kSize = 96;

Node node(const std::string& type) {
    Node out;
    out.type = type;
    return out;
}

Material diffuse() {
    Material material;
    material.name = "Diffuse";
    material.graph.nodes = {node("ShaderNodeBsdfDiffuse")};
    material.graph.nodes[0].inputs["Color"] = Vec4f(0.8f, 0.5f, 0.3f, 1.0f);
    material.graph.surface = {0, "BSDF"};
    return material;
}

/// Diffuse and clear in a pattern of noise, so that opacity runs before visibility.
Material lace() {
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
GeometryData sheet(int n, float z) {
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

GeometryData hair(int count) {
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

void add(Scene& scene, GeometryData data, std::int32_t material, const Vec3d& motion) {
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
std::shared_ptr<Scene> make_scene(int threads) {
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
    add(*scene, sheet(60, 70.0f), 1, Vec3d(5.0, 3.0, 0.0));
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

struct Picture {
    std::vector<Vec4f> combined = std::vector<Vec4f>(kSize * kSize);
    std::vector<Warning> warnings;
    std::uint64_t pieces_shared = 0;
};

Picture render(const std::shared_ptr<Scene>& scene) {
    Picture picture;
    RenderJob job(scene);
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
    return picture;
}

bool equal(const Picture& a, const Picture& b) {
    return std::memcmp(a.combined.data(), b.combined.data(), kSize * kSize * sizeof(Vec4f)) == 0;
}

TEST(FrameThreads, no_bit_depends_on_their_number) {
    const Picture alone = render(make_scene(1));
    EXPECT_GT(glm::length(alone.combined[kSize * kSize / 2 + kSize / 2]), 0.1f);
    for (int round = 0; round < 3; ++round)
        for (const int threads : {2, 3, 7}) EXPECT_TRUE(equal(alone, render(make_scene(threads))));
}

TEST(FrameThreads, one_bucket_is_shared_by_all) {
    const auto scene = [](int threads) {
        auto made = make_scene(threads);
        made->options.bucket_size = 128;
        return made;
    };
    const Picture alone = render(scene(1));
    EXPECT_EQ(alone.pieces_shared, 0u);
    // Who takes a piece is the system's to say: a busy machine may need more than one frame.
    std::uint64_t shared = 0;
    for (int round = 0; round < 100 && shared == 0; ++round) {
        const Picture picture = render(scene(6));
        EXPECT_TRUE(equal(alone, picture));
        shared = picture.pieces_shared;
    }
    EXPECT_GT(shared, 0u);
}

TEST(FrameThreads, a_frame_goes_on_with_the_threads_that_can_be_made) {
    const Picture alone = render(make_scene(1));
    const NoNewThreads none;
    const Picture picture = render(make_scene(1024));
    EXPECT_TRUE(equal(alone, picture));
    ASSERT_EQ(picture.warnings.size(), 1u);
    EXPECT_EQ(picture.warnings[0].message, "the system allowed 1 of 1024 threads");
}

TEST(FrameThreads, a_cancelled_frame_ends_on_all_of_them) {
    RenderJob at_once(make_scene(5));
    at_once.cancel();
    EXPECT_THROW(at_once.finish(), Cancelled);
    // Later its own end may come first; that one of them comes is the test.
    for (int round = 0; round < 3; ++round) {
        RenderJob job(make_scene(5));
        job.take_tiles(0.05);
    }
}
TEST(FrameThreads, a_cancelled_frame_is_done_though_nobody_takes_its_tiles) {
    for (int milliseconds = 0; milliseconds < 60; milliseconds += 6) {
        RenderJob job(make_scene(5));
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        job.cancel();
        try {
            job.finish();
        } catch (const Cancelled&) {
        }
        EXPECT_TRUE(job.done());
        EXPECT_TRUE(job.take_tiles(0.0).empty());
    }
}

}  // namespace
}  // namespace granita
