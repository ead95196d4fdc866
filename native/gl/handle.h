// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <utility>

namespace granita::gl {

/// Owns one OpenGL name.  Move-only.  Made and destroyed on the thread whose context is current;
/// where no context is, the name is left to end with its own context, because a call would end the
/// process.
template <void (*Delete)(GLuint)>
class Handle {
  public:
    Handle() = default;
    explicit Handle(GLuint name) : m_name(name) {}
    Handle(Handle&& other) noexcept : m_name(std::exchange(other.m_name, 0)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(m_name, other.m_name);
        return *this;
    }
    ~Handle() {
        if (m_name != 0 && eglGetCurrentContext() != EGL_NO_CONTEXT) Delete(m_name);
    }
    GLuint name() const { return m_name; }

  private:
    GLuint m_name = 0;
};

}  // namespace granita::gl
