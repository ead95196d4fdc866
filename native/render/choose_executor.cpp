// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/choose_executor.h"

#include "base/error.h"

namespace granita {
namespace {

/// What keeps the raster executor from rendering the scene; empty = nothing.
std::string raster_obstacle(const Scene& scene, const ShadingSystem& shading) {
    if (scene.options.sampling != Sampling::Regular) return "sampling is not Regular";
    if (scene.camera.projection.has_lens()) return "the camera has depth of field";
    if (scene.moves()) return "something moves";
    for (int m = -1; m < static_cast<int>(scene.materials.size()); ++m)
        if (shading.opacity_varies(m)) return "a material is transparent";
    for (const Instance& instance : scene.instances)
        if (instance.holdout) return "there is a holdout";
    if (!scene.options.film_transparent && !shading.background_is_constant())
        return "the world is not one colour";
    return {};
}

ExecutorChoice cpu(Executor executor) {
    return {executor, nullptr, executor == Executor::Reference ? "CPU (reference)" : "CPU (simd)"};
}

ExecutorChoice raster(gl::DeviceChoice device) {
    ExecutorChoice choice{
        Executor::Raster, std::make_unique<gl::GlThread>(gl::ContextOptions{.device = device}), {}};
    choice.device = "GPU (raster, " + choice.gl->info().renderer + ")";
    return choice;
}

}  // namespace

ExecutorChoice choose_executor(const Scene& scene, const ShadingSystem& shading, Report& report) {
    const Options& options = scene.options;
    if (options.executor == Executor::Raster) {
        if (const std::string obstacle = raster_obstacle(scene, shading); !obstacle.empty())
            throw SceneError("render settings",
                             "the raster executor cannot render this: " + obstacle);
        return raster(gl::DeviceChoice::Any);
    }
    if (options.executor != Executor::Auto) return cpu(options.executor);
    if (options.device != Device::Gpu) return cpu(Executor::Simd);
    try {
        const std::string obstacle = raster_obstacle(scene, shading);
        // A software driver is no GPU: the CPU executors are faster and do more.
        if (obstacle.empty()) return raster(gl::DeviceChoice::Hardware);
        report.warn("render settings", "the GPU was asked for, the CPU renders: " + obstacle);
    } catch (const GlError& error) {
        report.warn("render settings",
                    std::string("the GPU was asked for, the CPU renders: ") + error.what());
    }
    return cpu(Executor::Simd);
}

}  // namespace granita
