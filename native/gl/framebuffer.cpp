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

Framebuffer::Framebuffer(const Texture* color, const Texture* depth)
    : Framebuffer(color != nullptr ? std::vector{color} : std::vector<const Texture*>{}, depth) {}

Framebuffer::Framebuffer(const std::vector<const Texture*>& colors, const Texture* depth)
    : m_handle(create()) {
    std::vector<GLenum> outputs;
    for (const Texture* color : colors) {
        outputs.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(outputs.size()));
        glNamedFramebufferTexture(name(), outputs.back(), color->name(), 0);
    }
    glNamedFramebufferDrawBuffers(name(), static_cast<GLsizei>(outputs.size()), outputs.data());
    if (depth != nullptr) glNamedFramebufferTexture(name(), GL_DEPTH_ATTACHMENT, depth->name(), 0);
    const GLenum status = glCheckNamedFramebufferStatus(name(), GL_FRAMEBUFFER);
    check("making a framebuffer");
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw GlError("the driver refuses a framebuffer (status " + std::to_string(status) + ")");
}

}  // namespace granita::gl
