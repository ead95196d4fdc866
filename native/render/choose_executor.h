// SPDX-License-Identifier: GPL-3.0-or-later
// Which executor renders the frame.
#pragma once

#include <memory>
#include <string>

#include "base/report.h"
#include "gl/gl_thread.h"
#include "hider/compute_device.h"
#include "scene/scene.h"

namespace granita {

struct ExecutorChoice {
    Executor executor = Executor::Simd;      ///< never Auto
    std::unique_ptr<gl::GlThread> gl;        ///< Raster and Compute
    std::unique_ptr<ComputeDevice> compute;  ///< Compute only
    std::string device;                      ///< for statistics and the artist, e.g. "CPU (simd)"
};

/// An explicit Options::executor wins over the device, and throws SceneError or GlError where it
/// cannot be had. A device that cannot do what the scene needs is replaced by the CPU, with a
/// warning that says why.
ExecutorChoice choose_executor(const Scene& scene, Report& report);

}  // namespace granita
