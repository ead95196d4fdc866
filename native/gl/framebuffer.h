// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gl/handle.h"
#include "gl/texture.h"

namespace granita::gl {

/// Where drawing goes: a colour texture, a depth texture, or both.  Does not own them.
class Framebuffer {
  public:
    Framebuffer() = default;
    /// Either may be nullptr.  Throws GlError where the driver refuses the combination.
    Framebuffer(const Texture* color, const Texture* depth);

    void bind() const { glBindFramebuffer(GL_FRAMEBUFFER, name()); }
    GLuint name() const { return m_handle.name(); }

  private:
    static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
    Handle<&Framebuffer::destroy> m_handle;
};

}  // namespace granita::gl
