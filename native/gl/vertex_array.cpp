// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/vertex_array.h"

namespace granita::gl {
namespace {

GLuint create() {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    return name;
}

}  // namespace

VertexArray::VertexArray() : m_handle(create()) {}

void VertexArray::set_floats(GLuint location, const Buffer& buffer, int components) const {
    const GLuint array = m_handle.name();
    glVertexArrayVertexBuffer(array, location, buffer.name(), 0,
                              static_cast<GLsizei>(components * sizeof(float)));
    glVertexArrayAttribFormat(array, location, components, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, location, location);
    glEnableVertexArrayAttrib(array, location);
}

void VertexArray::set_uints(GLuint location, const Buffer& buffer, bool by_instance) const {
    const GLuint array = m_handle.name();
    glVertexArrayVertexBuffer(array, location, buffer.name(), 0, sizeof(GLuint));
    glVertexArrayAttribIFormat(array, location, 1, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(array, location, location);
    glVertexArrayBindingDivisor(array, location, by_instance ? 1 : 0);
    glEnableVertexArrayAttrib(array, location);
}

void VertexArray::set_indices(const Buffer& buffer) const {
    glVertexArrayElementBuffer(m_handle.name(), buffer.name());
}

}  // namespace granita::gl
