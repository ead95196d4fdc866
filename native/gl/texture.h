// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "gl/buffer.h"
#include "gl/handle.h"

namespace granita::gl {

/// A rectangle of texels, [y * height][x]; row 0 is the lowest.
struct TexelRect {
    int x = 0, y = 0, width = 0, height = 0;
};

/// A 2-D texture of one level, or an array of such.
class Texture {
  public:
    Texture() = default;
    /// `format`: sized, e.g. GL_RGBA32F; layers 0: no array.  Throws GlError beyond the driver's
    /// limits.
    Texture(GLenum format, int width, int height, int layers = 0);

    int width() const { return m_width; }
    int height() const { return m_height; }
    GLuint name() const { return m_handle.name(); }
    void bind(GLuint unit) const { glBindTextureUnit(unit, name()); }
    /// For shaders that load and store texels; all layers.
    void bind_image(GLuint unit, GLenum access) const;
    /// Texels of a part of all layers; `value`: as many as the format has components.
    void clear(const TexelRect& rect, const float* value) const;
    void clear(const TexelRect& rect, const GLuint* value) const;

    /// Texels of a part, row by row; waits for the device.  `components` is GL_RGBA,
    /// GL_RED_INTEGER, GL_DEPTH_COMPONENT..., T its type (float or uint32_t).
    template <class T>
    std::vector<T> read(const TexelRect& rect, GLenum components, int component_count,
                        int layer = 0) const {
        std::vector<T> texels(static_cast<std::size_t>(rect.width) * rect.height * component_count);
        static_assert(std::is_same_v<T, float> || std::is_same_v<T, std::uint32_t>);
        const GLenum type = std::is_same_v<T, float> ? GL_FLOAT : GL_UNSIGNED_INT;
        read_texels(rect, layer, components, type, texels.size() * sizeof(T), texels.data());
        return texels;
    }

    /// RGBA floats of a part, row by row, to the beginning of a buffer; of a texture without
    /// layers.
    void copy_to(const Buffer& buffer, const TexelRect& rect) const;

  private:
    void read_texels(const TexelRect& rect, int layer, GLenum components, GLenum type,
                     std::size_t bytes, void* out) const;
    static void destroy(GLuint name) { glDeleteTextures(1, &name); }
    Handle<&Texture::destroy> m_handle;
    GLenum m_format = 0;
    int m_width = 0, m_height = 0, m_layers = 0;
};

}  // namespace granita::gl
