// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/texture.h"

#include <algorithm>
#include <string>

#include "gl/gl_check.h"

namespace granita::gl {
namespace {

GLuint create(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    return name;
}

/// The client format that clears a texture of one or four components.
GLenum components_of(GLenum format) {
    switch (format) {
        case GL_R32F:
            return GL_RED;
        case GL_R32UI:
            return GL_RED_INTEGER;
        case GL_DEPTH_COMPONENT32F:
            return GL_DEPTH_COMPONENT;
        default:
            return GL_RGBA;
    }
}

}  // namespace

Texture::Texture(GLenum format, int width, int height, int layers)
    : m_handle(create(layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D)),
      m_format(format),
      m_width(width),
      m_height(height),
      m_layers(layers) {
    if (layers > 0)
        glTextureStorage3D(name(), 1, format, width, height, layers);
    else
        glTextureStorage2D(name(), 1, format, width, height);
    glTextureParameteri(name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    check("making a texture of " + std::to_string(width) + " x " + std::to_string(height));
}

void Texture::bind_image(GLuint unit, GLenum access) const {
    glBindImageTexture(unit, name(), 0, m_layers > 0 ? GL_TRUE : GL_FALSE, 0, access, m_format);
}

void Texture::clear(const TexelRect& rect, const float* value) const {
    glClearTexSubImage(name(), 0, rect.x, rect.y, 0, rect.width, rect.height, std::max(m_layers, 1),
                       components_of(m_format), GL_FLOAT, value);
}

void Texture::clear(const TexelRect& rect, const GLuint* value) const {
    glClearTexSubImage(name(), 0, rect.x, rect.y, 0, rect.width, rect.height, std::max(m_layers, 1),
                       components_of(m_format), GL_UNSIGNED_INT, value);
}

void Texture::read_texels(const TexelRect& rect, int layer, GLenum components, GLenum type,
                          std::size_t bytes, void* out) const {
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glGetTextureSubImage(name(), 0, rect.x, rect.y, layer, rect.width, rect.height, 1, components,
                         type, static_cast<GLsizei>(bytes), out);
    check("reading a texture");
}

void Texture::copy_to(const Buffer& buffer, const TexelRect& rect) const {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer.name());
    read_texels(rect, 0, GL_RGBA, GL_FLOAT, buffer.size(), nullptr);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

}  // namespace granita::gl
