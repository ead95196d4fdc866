// SPDX-License-Identifier: GPL-3.0-or-later
// A headless OpenGL 4.5 core context through EGL.
//
// Thread rule: the constructor makes the context current on the calling thread; the object is used
// and destroyed there.  GlThread (gl_thread.h) is the usual owner.
#pragma once

#include <epoxy/egl.h>

#include <functional>
#include <string>

#include "gl/egl_display.h"

namespace granita::gl {

enum class DeviceChoice {
    Any,       ///< hardware if there is any, else software
    Hardware,  ///< GlError where there is none
    Software
};

/// What the driver says of itself.
struct ContextInfo {
    std::string display, vendor, renderer, version;
    bool software = false;
    int max_texture_size = 0;             ///< texels; also bounds viewports and renderbuffers
    int vertex_storage_blocks = 0;        ///< that a vertex shader may read
    bool layer_in_vertex_shader = false;  ///< GL_ARB_shader_viewport_layer_array
};

/// Stands in for drivers that fail, which no test can order otherwise.  Both are called on the
/// context's thread.
struct DriverFaults {
    /// Changes what the driver says.
    std::function<void(ContextInfo&)> boast = {};
    /// In every check(); may throw GlError.
    std::function<void(const std::string& what)> at_check = {};
};

struct ContextOptions {
    DeviceChoice device = DeviceChoice::Any;
    bool debug = false;  ///< the driver's own messages in errors; slower
    DriverFaults faults = {};
};

class EglContext {
  public:
    /// Throws GlError with the reason of every display that was tried.
    explicit EglContext(const ContextOptions& options = {});
    ~EglContext();
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

    const ContextInfo& info() const { return m_info; }
    void make_current();

  private:
    void open(const Display& display, const ContextOptions& options);
    void close();

    /// With notice of resets where the driver can give it; m_context stays none where it can not.
    void create(EGLConfig config, bool debug, bool notify);

    EGLDisplay m_display = EGL_NO_DISPLAY;
    EGLContext m_context = EGL_NO_CONTEXT;
    ContextInfo m_info;
};

}  // namespace granita::gl
