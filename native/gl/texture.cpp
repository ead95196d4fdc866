// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/texture.h"

#include <string>

#include "gl/gl_check.h"

namespace granita::gl {
namespace {

GLuint create() {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    return name;
}

}  // namespace

Texture::Texture(GLenum format, int width, int height)
    : m_handle(create()), m_width(width), m_height(height) {
    glTextureStorage2D(name(), 1, format, width, height);
    glTextureParameteri(name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    check("making a texture of " + std::to_string(width) + " x " + std::to_string(height));
}

void Texture::read_texels(const TexelRect& rect, GLenum components, GLenum type, std::size_t bytes,
                          void* out) const {
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glGetTextureSubImage(name(), 0, rect.x, rect.y, 0, rect.width, rect.height, 1, components, type,
                         static_cast<GLsizei>(bytes), out);
    check("reading a texture");
}

}  // namespace granita::gl
