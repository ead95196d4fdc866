// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/gl_check.h"

#include <epoxy/gl.h>

#include <cstdint>
#include <mutex>
#include <utility>

#include "base/error.h"

namespace granita::gl {
namespace {

thread_local std::string t_missing_entry;
thread_local std::string t_debug_messages;
thread_local std::function<void(const std::string&)> t_check_hook;

// Stands in for any missing entry point: on the C ABIs we run on extra arguments are ignored.
std::uintptr_t missing_entry_stub() {
    return 0;
}

epoxy_resolver_stub_t record_missing_entry(const char* name) {
    t_missing_entry = name;
    return reinterpret_cast<epoxy_resolver_stub_t>(&missing_entry_stub);
}

void APIENTRY record_debug_message(GLenum, GLenum type, GLuint, GLenum, GLsizei length,
                                   const GLchar* message, const void*) {
    if (type != GL_DEBUG_TYPE_ERROR) return;
    t_debug_messages += "\n  ";
    t_debug_messages.append(message, length < 0 ? std::char_traits<char>::length(message)
                                                : static_cast<std::size_t>(length));
}

const char* error_name(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        default:
            return "unknown OpenGL error";
    }
}

}  // namespace

void install_missing_entry_handler() {
    static std::once_flag once;
    std::call_once(once, [] { epoxy_set_resolver_failure_handler(record_missing_entry); });
}

void check_entry_points(const std::string& what) {
    if (t_missing_entry.empty()) return;
    const std::string entry = std::exchange(t_missing_entry, {});
    throw GlError(what + ": the driver has no " + entry);
}

void check(const std::string& what) {
    check_entry_points(what);
    std::string names;
    // A lost context may answer with an error for ever: OpenGL keeps few flags, so a few are read.
    for (int flag = 0; flag < 8; ++flag) {
        const GLenum error = glGetError();
        if (error == GL_NO_ERROR) break;
        names += names.empty() ? "" : ", ";
        names += error_name(error);
    }
    const std::string messages = std::exchange(t_debug_messages, {});
    if (!names.empty()) throw GlError(what + ": " + names + messages);
    if (glGetGraphicsResetStatus() != GL_NO_ERROR)
        throw GlError(what + ": the driver has reset the GPU");
    if (t_check_hook) t_check_hook(what);
}

void set_check_hook(std::function<void(const std::string&)> hook) {
    t_check_hook = std::move(hook);
}

void collect_debug_messages() {
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(record_debug_message, nullptr);
}

}  // namespace granita::gl
