// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/compute/compute_device.h"

#include <string>

#include "base/error.h"
#include "gl/shader_source.h"
#include "shaders/shared/compute_layout.h"

namespace granita {

ComputeDevice::ComputeDevice(gl::GlThread& thread, const ComputeLimits& limits)
    : m_thread(thread), m_limits(limits) {
    thread.run([&] {
        GLint64 bytes = 0;
        glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
        if (bytes < static_cast<GLint64>(limits.buffer_bytes))
            throw GlError("the compute executor needs storage buffers of " +
                          std::to_string(limits.buffer_bytes) + " bytes, the device has " +
                          std::to_string(bytes));
        // A device that cannot compile shaders should say so now, while the CPU can step in.
        hide({COMPUTE_PASS_OPAQUE, false, false});
        farthest();
    });
}

ComputeDevice::~ComputeDevice() {
    m_thread.run([&] {
        m_hide.clear();
        m_farthest = {};
    });
}

const gl::Program& ComputeDevice::hide(const Variant& variant) {
    const auto found = m_hide.find(variant);
    if (found != m_hide.end()) return found->second;
    const gl::Defines defines{{"PASS", std::to_string(variant.pass)},
                              {"MOTION", variant.motion ? "1" : "0"},
                              {"LENS", variant.lens ? "1" : "0"}};
    gl::Program program("hide",
                        {{GL_COMPUTE_SHADER, gl::shader_source("compute/hide.comp", defines)}});
    return m_hide.emplace(variant, std::move(program)).first->second;
}

const gl::Program& ComputeDevice::farthest() {
    if (m_farthest.name() == 0)
        m_farthest = gl::Program("farthest keys",
                                 {{GL_COMPUTE_SHADER, gl::shader_source("compute/farthest.comp")}});
    return m_farthest;
}

}  // namespace granita
