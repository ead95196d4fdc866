// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>

#include "gl/gl_thread.h"
#include "gl/program.h"
#include "hider/compute/compute_batch.h"

namespace granita {

/// Programs of the compute executor, made when first needed; one object a frame, shared by its
/// buckets' hiders, which it must outlive.
class ComputeDevice {
  public:
    /// Throws GlError where the device cannot have buffers of `limits` or compile the shaders.
    explicit ComputeDevice(gl::GlThread& thread, const ComputeLimits& limits = {});
    ~ComputeDevice();
    ComputeDevice(const ComputeDevice&) = delete;
    ComputeDevice& operator=(const ComputeDevice&) = delete;

    gl::GlThread& thread() const { return m_thread; }
    const ComputeLimits& limits() const { return m_limits; }

    // On the thread that owns OpenGL:

    /// `pass`: COMPUTE_PASS_... of shaders/shared/compute_layout.h.
    struct Variant {
        int pass;
        bool motion, lens;
        auto operator<=>(const Variant&) const = default;
    };
    const gl::Program& hide(const Variant& variant);
    const gl::Program& farthest();

  private:
    gl::GlThread& m_thread;
    ComputeLimits m_limits;
    std::map<Variant, gl::Program> m_hide;
    gl::Program m_farthest;
};

}  // namespace granita
