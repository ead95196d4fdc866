// SPDX-License-Identifier: GPL-3.0-or-later
// Which executor renders the frame.
#pragma once

#include <memory>
#include <string>

#include "base/error.h"
#include "base/report.h"
#include "gl/gl_thread.h"
#include "hider/compute/compute_device.h"
#include "scene/scene.h"

namespace granita {

struct ExecutorChoice {
    Executor executor = Executor::Simd;      ///< never Auto
    std::unique_ptr<gl::GlThread> gl;        ///< Raster and Compute
    std::unique_ptr<ComputeDevice> compute;  ///< Compute only
    std::string device;                      ///< for statistics and the artist, e.g. "CPU (simd)"
};

/// What a frame without a named executor takes for a GPU.  A software driver is none: the CPU
/// executors are faster and do more.
inline const gl::ContextOptions kHardware{gl::DeviceChoice::Hardware, false, {}};

/// An explicit Options::executor wins over the device, and throws SceneError or GlError where it
/// cannot be had. A device that cannot do what the scene needs is replaced by the CPU, with a
/// warning that says why.
ExecutorChoice choose_executor(const Scene& scene, Report& report,
                               const gl::ContextOptions& gpu = kHardware);

/// The CPU in place of a GPU that failed, before or in the frame, with one warning.  Throws the
/// error again where the artist has named the executor.
ExecutorChoice cpu_instead(const Scene& scene, const GlError& error, Report& report);

}  // namespace granita
