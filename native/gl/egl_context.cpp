// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/egl_context.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "base/error.h"
#include "gl/gl_check.h"

namespace granita::gl {
namespace {

[[noreturn]] void throw_egl(const std::string& what) {
    static constexpr char kDigits[] = "0123456789ABCDEF";
    const unsigned code = static_cast<unsigned>(eglGetError());
    std::string hex = "0x";
    for (int shift = 12; shift >= 0; shift -= 4) hex += kDigits[code >> shift & 15];
    throw GlError(what + " failed with EGL error " + hex);
}

std::string gl_string(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text ? reinterpret_cast<const char*>(text) : "";
}

bool is_software_renderer(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

ContextInfo query_info(const Display& display) {
    ContextInfo info;
    info.display = display.name;
    info.vendor = gl_string(GL_VENDOR);
    info.renderer = gl_string(GL_RENDERER);
    info.version = gl_string(GL_VERSION);
    info.software = display.software || is_software_renderer(info.renderer);
    GLint texture = 0, renderbuffer = 0, viewport[2] = {0, 0};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    info.max_texture_size = std::min({texture, renderbuffer, viewport[0], viewport[1]});
    glGetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &info.vertex_storage_blocks);
    info.layer_in_vertex_shader = epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array");
    return info;
}

}  // namespace

EglContext::EglContext(const ContextOptions& options) {
    std::string reasons;
    for (const Display& display : headless_displays()) {
        if (options.device == DeviceChoice::Hardware && display.software) continue;
        try {
            open(display, options);
            const bool unwanted = (options.device == DeviceChoice::Hardware && m_info.software) ||
                                  (options.device == DeviceChoice::Software && !m_info.software);
            if (!unwanted) return;
            throw GlError("is " + m_info.renderer);
        } catch (const GlError& error) {
            reasons += "\n  " + display.name + ": " + error.what();
            close();
        }
    }
    throw GlError("no " +
                  std::string(options.device == DeviceChoice::Hardware   ? "hardware "
                              : options.device == DeviceChoice::Software ? "software "
                                                                         : "") +
                  "OpenGL 4.5 context" + reasons);
}

EglContext::~EglContext() {
    close();
}

void EglContext::open(const Display& display, const ContextOptions& options) {
    m_display = display.display;
    EGLint major = 0, minor = 0;
    if (!eglInitialize(m_display, &major, &minor)) throw_egl("eglInitialize");
    const char* extensions = eglQueryString(m_display, EGL_EXTENSIONS);
    if (!has_extension(extensions, "EGL_KHR_surfaceless_context"))
        throw GlError("EGL_KHR_surfaceless_context is missing");
    if (!eglBindAPI(EGL_OPENGL_API)) throw_egl("eglBindAPI");

    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                        EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint config_count = 0;
    if (!eglChooseConfig(m_display, config_attributes, &config, 1, &config_count))
        throw_egl("eglChooseConfig");
    if (config_count == 0) throw GlError("no EGL configuration for OpenGL");

    create(config, options.debug, true);
    if (m_context == EGL_NO_CONTEXT) create(config, options.debug, false);
    if (m_context == EGL_NO_CONTEXT) throw_egl("eglCreateContext (OpenGL 4.5 core)");
    make_current();
    m_info = query_info(display);
    if (options.debug) collect_debug_messages();
    set_check_hook(options.faults.at_check);
    check("preparing the context");
    if (options.faults.boast) options.faults.boast(m_info);
}

void EglContext::create(EGLConfig config, bool debug, bool notify) {
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 debug ? EGL_TRUE : EGL_FALSE,
                                 notify ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY : EGL_NONE,
                                 EGL_LOSE_CONTEXT_ON_RESET,
                                 EGL_NONE};
    m_context = eglCreateContext(m_display, config, EGL_NO_CONTEXT, attributes);
}

void EglContext::make_current() {
    if (!eglMakeCurrent(m_display, EGL_NO_SURFACE, EGL_NO_SURFACE, m_context))
        throw_egl("eglMakeCurrent");
}

// The display stays initialised: EGL shares it with everybody in the process who asks for the same
// device (Blender may), and eglTerminate would end their contexts with ours.
void EglContext::close() {
    if (m_context == EGL_NO_CONTEXT) return;
    eglMakeCurrent(m_display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(m_display, m_context);
    m_context = EGL_NO_CONTEXT;
    set_check_hook({});
}

}  // namespace granita::gl
