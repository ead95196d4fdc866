// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/choose_executor.h"

#include <algorithm>

#include "base/error.h"
#include "scene/channels.h"

namespace granita {
namespace {

/// A world that the camera sees in one colour, to go by its nodes.
bool is_plain(const World& world) {
    return !world.visible_camera ||
           std::all_of(world.graph.nodes.begin(), world.graph.nodes.end(),
                       [](const Node& node) { return node.type == "ShaderNodeBackground"; });
}

/// What keeps the raster executor from rendering the scene; empty = nothing.
std::string raster_obstacle(const Scene& scene) {
    const Camera& camera = scene.camera;
    if (scene.options.sampling == Sampling::Regular) {
        // All samples of a pass have one time.
        if (scene.options.rolling_shutter >= 0.0f) return "the shutter rolls";
    } else if (!scene.options.film_transparent &&
               (camera.world_from_camera.size() > 1 || camera.projection.has_lens()) &&
               !is_plain(scene.world)) {
        // The world is evaluated at the corners of pixels, for whole passes.
        return "the world would differ from sample to sample";
    }
    if (std::ranges::any_of(scene.materials,
                            [](const Material& m) { return m.graph.has_volume(); }) ||
        scene.world.graph.has_volume())
        return "something is filled by a volume";
    if (scene.has_shadow_catchers()) return "something catches shadows";
    if (!ChannelSet(scene.options).empty()) return "passes beside Combined and Depth are asked for";
    return {};
}

ExecutorChoice cpu(Executor executor) {
    return {executor, nullptr, nullptr,
            executor == Executor::Reference ? "CPU (reference)" : "CPU (simd)"};
}

ExecutorChoice raster(const gl::ContextOptions& context) {
    ExecutorChoice choice{Executor::Raster, std::make_unique<gl::GlThread>(context), nullptr, {}};
    choice.device = "GPU (raster, " + choice.gl->info().renderer + ")";
    return choice;
}

ExecutorChoice compute(const gl::ContextOptions& context) {
    ExecutorChoice choice{Executor::Compute, std::make_unique<gl::GlThread>(context), nullptr, {}};
    choice.compute = std::make_unique<ComputeDevice>(*choice.gl);
    choice.device = "GPU (compute, " + choice.gl->info().renderer + ")";
    return choice;
}

}  // namespace

ExecutorChoice choose_executor(const Scene& scene, Report& report, const gl::ContextOptions& gpu) {
    const Options& options = scene.options;
    const gl::ContextOptions any{gl::DeviceChoice::Any, gpu.debug, gpu.faults};
    if (options.executor == Executor::Raster) {
        if (const std::string obstacle = raster_obstacle(scene); !obstacle.empty())
            throw SceneError("render settings",
                             "the raster executor cannot render this: " + obstacle);
        return raster(any);
    }
    if (options.executor == Executor::Compute) return compute(any);
    if (options.executor != Executor::Auto) return cpu(options.executor);
    if (options.device != Device::Gpu) return cpu(Executor::Simd);
    try {
        const bool passes = options.sampling == Sampling::Regular && raster_obstacle(scene).empty();
        return passes ? raster(gpu) : compute(gpu);
    } catch (const GlError& error) {
        return cpu_instead(scene, error, report);
    }
}

ExecutorChoice cpu_instead(const Scene& scene, const GlError& error, Report& report) {
    if (scene.options.executor != Executor::Auto) throw error;
    report.warn("render settings",
                std::string("the GPU was asked for, the CPU renders: ") + error.what());
    return cpu(Executor::Simd);
}

}  // namespace granita
