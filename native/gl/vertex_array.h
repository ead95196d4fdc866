// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gl/buffer.h"
#include "gl/handle.h"

namespace granita::gl {

/// Which buffers feed the vertex shader.  Does not own them.
class VertexArray {
  public:
    VertexArray();
    /// `components` floats a vertex, tightly packed, as attribute `location`.
    void set_floats(GLuint location, const Buffer& buffer, int components) const;
    /// One unsigned integer a vertex or, with `by_instance`, an instance.
    void set_uints(GLuint location, const Buffer& buffer, bool by_instance = false) const;
    /// 32-bit vertex indices.
    void set_indices(const Buffer& buffer) const;
    void bind() const { glBindVertexArray(m_handle.name()); }

  private:
    static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
    Handle<&VertexArray::destroy> m_handle;
};

}  // namespace granita::gl
