// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/framebuffer.h"

#include <string>

#include "base/error.h"
#include "gl/gl_check.h"

namespace granita::gl {
namespace {

GLuint create() {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    return name;
}

}  // namespace

Framebuffer::Framebuffer(const Texture* color, const Texture* depth) : m_handle(create()) {
    if (color != nullptr)
        glNamedFramebufferTexture(name(), GL_COLOR_ATTACHMENT0, color->name(), 0);
    else
        glNamedFramebufferDrawBuffer(name(), GL_NONE);
    if (depth != nullptr) glNamedFramebufferTexture(name(), GL_DEPTH_ATTACHMENT, depth->name(), 0);
    const GLenum status = glCheckNamedFramebufferStatus(name(), GL_FRAMEBUFFER);
    check("making a framebuffer");
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw GlError("the driver refuses a framebuffer (status " + std::to_string(status) + ")");
}

}  // namespace granita::gl
