// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "gl/handle.h"
#include "gl/texture.h"

namespace granita::gl {

/// Where drawing goes: colour textures, a depth texture, or both.  Does not own them.  Of texture
/// arrays all layers are attached: gl_Layer chooses.
class Framebuffer {
  public:
    Framebuffer() = default;
    /// Either may be nullptr.  Throws GlError where the driver refuses the combination.
    Framebuffer(const Texture* color, const Texture* depth);
    /// Fragment output i goes to colors[i].
    Framebuffer(const std::vector<const Texture*>& colors, const Texture* depth);

    void bind() const { glBindFramebuffer(GL_FRAMEBUFFER, name()); }
    GLuint name() const { return m_handle.name(); }

  private:
    static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
    Handle<&Framebuffer::destroy> m_handle;
};

}  // namespace granita::gl
