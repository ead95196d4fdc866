// SPDX-License-Identifier: GPL-3.0-or-later
// A GPU that fails before or in the frame: the CPU's picture, bit by bit, and one warning.
//
// OpenGL is whatever driver there is, a software one too; failures are injected where a driver
// would report them (gl::DriverFaults).
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>

#include "base/error.h"
#include "render/render_job.h"

namespace granita {
namespace {

/// Sheets of emission, one of them moving and one half transparent, over 3 x 3 buckets.
std::shared_ptr<Scene> make_scene(Sampling sampling) {
    auto scene = std::make_shared<Scene>();
    Options& o = scene->options;
    o.width = o.height = 80;
    o.crop = {0, 0, 80, 80};
    o.bucket_size = 32;
    o.samples = 9;
    o.time_samples = 3;
    o.sampling = sampling;
    o.threads = 2;
    o.film_transparent = true;
    o.device = Device::Gpu;
    scene->camera.world_from_camera = {Mat4d(1.0)};
    Projection& p = scene->camera.projection;
    p.perspective = false;
    p.scale = {1.0, 1.0};
    p.near_clip = 0.01;
    p.far_clip = 100.0;
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<float>(i);
        Material material;
        material.name = "Glow";
        Node glow;
        glow.type = "ShaderNodeEmission";
        glow.inputs["Color"] = Vec4f(0.3f + 0.3f * k, 1.0f - 0.2f * k, 0.5f, 1.0f);
        glow.inputs["Strength"] = Vec4f(1.0f);
        material.graph.nodes = {glow};
        material.graph.surface = {0, "Emission"};
        if (i == 1) {
            Node clear, mix;
            clear.type = "ShaderNodeBsdfTransparent";
            clear.inputs["Color"] = Vec4f(1.0f);
            mix.type = "ShaderNodeMixShader";
            mix.inputs["Fac"] = Vec4f(0.5f);
            mix.inputs["Shader"] = NodeLink{1, "BSDF"};
            mix.inputs["Shader_001"] = NodeLink{0, "Emission"};
            material.graph.nodes = {glow, clear, mix};
            material.graph.surface = {2, "Shader"};
        }
        scene->materials.push_back(material);
        GeometryData sheet;
        sheet.name = "mesh 'Sheet'";
        const float x0 = 5.3f + 9.0f * k, y0 = 3.71f + 13.0f * k, z = 3.0f - k;
        sheet.points = {{x0, y0, z}, {x0 + 50, y0 + 5, z}, {x0 + 45, y0 + 40, z}, {x0, y0 + 38, z}};
        sheet.face_sizes = {4};
        sheet.corner_verts = {0, 1, 2, 3};
        scene->geometries.push_back(sheet);
        Instance instance;
        instance.name = "Sheet";
        instance.geometry = i;
        instance.key = static_cast<std::uint32_t>(i);
        instance.materials = {i};
        instance.world_from_object = {Mat4d(1.0)};
        if (i == 2) {
            Mat4d end(1.0);
            end[3] = {7.0, 2.0, 0.0, 1.0};
            instance.world_from_object.push_back(end);
        }
        scene->instances.push_back(instance);
    }
    return scene;
}

struct Result {
    std::vector<Vec4f> picture = std::vector<Vec4f>(80 * 80);
    std::vector<Warning> warnings;
    std::uint64_t cpu_tests = 0, gl_work = 0;
    std::string device;
};

Result render(const std::shared_ptr<Scene>& scene, const gl::DriverFaults& faults = {}) {
    Result result;
    RenderJob job(scene, {gl::DeviceChoice::Any, false, faults});
    while (!job.done())
        for (const Tile& tile : job.take_tiles(0.1))
            for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
                for (int x = tile.rect.x0; x < tile.rect.x1; ++x)
                    result.picture[static_cast<std::size_t>(80 * y + x)] =
                        tile.combined[static_cast<std::size_t>(
                            (y - tile.rect.y0) * tile.rect.width() + x - tile.rect.x0)];
    job.finish();
    result.warnings = job.report().warnings();
    const Statistics& s = job.statistics();
    result.cpu_tests = s.get(Counter::SampleTestsStatic) + s.get(Counter::SampleTestsMoving);
    result.gl_work = s.get(Counter::GlPrimitives) + s.get(Counter::GlDispatches);
    result.device = job.device();
    return result;
}

Result render_on_cpu(const std::shared_ptr<Scene>& scene) {
    scene->options.device = Device::Cpu;
    return render(scene);
}

/// No more than a few samples at edges fall otherwise.
void expect_same_picture(const Result& a, const Result& b) {
    int different = 0;
    for (std::size_t i = 0; i < a.picture.size(); ++i)
        different += glm::length(a.picture[i] - b.picture[i]) > 1e-5f;
    EXPECT_LE(different, 10);
}

/// Regular is the raster executor's, Independent the compute executor's.
class GpuLoss : public testing::TestWithParam<Sampling> {
  protected:
    void expect_cpu_picture(const Result& result, const std::string& reason) {
        const Result cpu = render_on_cpu(make_scene(GetParam()));
        EXPECT_EQ(std::memcmp(result.picture.data(), cpu.picture.data(),
                              cpu.picture.size() * sizeof(Vec4f)),
                  0);
        EXPECT_GT(result.cpu_tests, 0u);
        EXPECT_EQ(result.device, cpu.device);
        ASSERT_EQ(result.warnings.size(), 1u);
        EXPECT_EQ(result.warnings[0].count, 1u);
        EXPECT_NE(result.warnings[0].message.find("the CPU renders"), std::string::npos);
        EXPECT_NE(result.warnings[0].message.find(reason), std::string::npos)
            << result.warnings[0].message;
    }
};
INSTANTIATE_TEST_SUITE_P(Executors, GpuLoss,
                         testing::Values(Sampling::Regular, Sampling::Independent));

/// Fails for ever from call number `first` of check() on, where `what` begins with `prefix`.
gl::DriverFaults failing(const std::string& prefix, const std::string& error, int first = 0) {
    const auto calls = std::make_shared<std::atomic<int>>(0);
    gl::DriverFaults faults;
    faults.at_check = [=](const std::string& what) {
        if (what.rfind(prefix, 0) == 0 && (*calls)++ >= first) throw GlError(what + ": " + error);
    };
    return faults;
}

TEST_P(GpuLoss, nothing_lost_nothing_on_the_cpu) {
    const Result result = render(make_scene(GetParam()));
    EXPECT_EQ(result.cpu_tests, 0u);
    EXPECT_GT(result.gl_work, 0u);
    EXPECT_TRUE(result.warnings.empty());
    EXPECT_NE(result.device.find("GPU"), std::string::npos);
    expect_same_picture(result, render_on_cpu(make_scene(GetParam())));
}

/// What the raster executor does not do, the compute executor does on the same device: nobody has
/// to be told.
TEST(GpuChoice, passes_and_a_rolling_shutter_are_rendered_by_the_gpu_too) {
    for (const bool rolling : {true, false}) {
        const auto scene = [=] {
            auto made = make_scene(Sampling::Regular);
            if (rolling)
                made->options.rolling_shutter = 0.1f;
            else
                made->options.passes = {"Normal"};
            return made;
        };
        const Result result = render(scene());
        EXPECT_NE(result.device.find("compute"), std::string::npos) << result.device;
        EXPECT_EQ(result.cpu_tests, 0u);
        EXPECT_GT(result.gl_work, 0u);
        EXPECT_TRUE(result.warnings.empty());
        expect_same_picture(result, render_on_cpu(scene()));
    }
}

TEST_P(GpuLoss, no_context) {
    const Result result = render(make_scene(GetParam()), failing("preparing", "no such luck"));
    expect_cpu_picture(result, "no such luck");
    EXPECT_EQ(result.gl_work, 0u);
}

TEST_P(GpuLoss, context_lost_in_mid_frame) {
    const bool regular = GetParam() == Sampling::Regular;
    const Result result =
        render(make_scene(GetParam()),
               failing(regular ? "drawing grids" : "hiding micropolygons", "the GPU is gone", 4));
    expect_cpu_picture(result, "the GPU is gone");
    EXPECT_GT(result.gl_work, 0u);  // it had begun
}

TEST_P(GpuLoss, context_lost_while_a_copy_is_waited_for) {
    expect_cpu_picture(
        render(make_scene(GetParam()), failing("waiting for a copy", "the GPU is gone", 4)),
        "the GPU is gone");
}

TEST(RasterLoss, context_lost_among_the_layers) {
    const Result result =
        render(make_scene(Sampling::Regular), failing("compositing a layer", "the GPU is gone", 1));
    const Result cpu = render_on_cpu(make_scene(Sampling::Regular));
    EXPECT_EQ(
        std::memcmp(result.picture.data(), cpu.picture.data(), cpu.picture.size() * sizeof(Vec4f)),
        0);
    EXPECT_EQ(result.device, cpu.device);
}

TEST_P(GpuLoss, shader_that_does_not_compile) {
    expect_cpu_picture(render(make_scene(GetParam()), failing("making program", "syntax error")),
                       "syntax error");
}

TEST_P(GpuLoss, driver_without_the_memory_that_it_promised) {
    expect_cpu_picture(render(make_scene(GetParam()), failing("making a", "GL_OUT_OF_MEMORY", 2)),
                       "GL_OUT_OF_MEMORY");
}

TEST(RasterLoss, target_too_big) {
    gl::DriverFaults faults;
    faults.boast = [](gl::ContextInfo& info) { info.max_texture_size = 32; };
    const Result result = render(make_scene(Sampling::Regular), faults);
    ASSERT_EQ(result.warnings.size(), 1u);
    EXPECT_NE(result.warnings[0].message.find("texels a side"), std::string::npos);
    const Result cpu = render_on_cpu(make_scene(Sampling::Regular));
    EXPECT_EQ(result.picture, cpu.picture);
}

TEST_P(GpuLoss, a_named_executor_fails_loudly) {
    const auto scene = make_scene(GetParam());
    scene->options.executor =
        GetParam() == Sampling::Regular ? Executor::Raster : Executor::Compute;
    EXPECT_THROW(render(scene, failing("making program", "syntax error")), GlError);
}

}  // namespace
}  // namespace granita
