// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/choose_executor.h"

#include "base/error.h"
#include "scene/channels.h"

namespace granita {
namespace {

/// What keeps the raster executor from rendering the scene; empty = nothing.
std::string raster_obstacle(const Scene& scene) {
    if (scene.options.sampling != Sampling::Regular) return "sampling is not Regular";
    if (scene.options.rolling_shutter >= 0.0f) return "the shutter rolls";
    if (!ChannelSet(scene.options).empty()) return "passes beside Combined and Depth are asked for";
    return {};
}

ExecutorChoice cpu(Executor executor) {
    return {executor, nullptr, nullptr,
            executor == Executor::Reference ? "CPU (reference)" : "CPU (simd)"};
}

ExecutorChoice raster(gl::DeviceChoice device) {
    ExecutorChoice choice{Executor::Raster,
                          std::make_unique<gl::GlThread>(gl::ContextOptions{.device = device}),
                          nullptr,
                          {}};
    choice.device = "GPU (raster, " + choice.gl->info().renderer + ")";
    return choice;
}

ExecutorChoice compute(gl::DeviceChoice device) {
    ExecutorChoice choice{Executor::Compute,
                          std::make_unique<gl::GlThread>(gl::ContextOptions{.device = device}),
                          nullptr,
                          {}};
    choice.compute = std::make_unique<ComputeDevice>(*choice.gl);
    choice.device = "GPU (compute, " + choice.gl->info().renderer + ")";
    return choice;
}

}  // namespace

ExecutorChoice choose_executor(const Scene& scene, Report& report) {
    const Options& options = scene.options;
    if (options.executor == Executor::Raster) {
        if (const std::string obstacle = raster_obstacle(scene); !obstacle.empty())
            throw SceneError("render settings",
                             "the raster executor cannot render this: " + obstacle);
        return raster(gl::DeviceChoice::Any);
    }
    if (options.executor == Executor::Compute) return compute(gl::DeviceChoice::Any);
    if (options.executor != Executor::Auto) return cpu(options.executor);
    if (options.device != Device::Gpu) return cpu(Executor::Simd);
    try {
        const std::string obstacle = raster_obstacle(scene);
        // A software driver is no GPU: the CPU executors are faster and do more.
        if (obstacle.empty()) return raster(gl::DeviceChoice::Hardware);
        return compute(gl::DeviceChoice::Hardware);
    } catch (const GlError& error) {
        report.warn("render settings",
                    std::string("the GPU was asked for, the CPU renders: ") + error.what());
    }
    return cpu(Executor::Simd);
}

}  // namespace granita
