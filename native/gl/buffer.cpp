// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/buffer.h"

#include <algorithm>
#include <string>

#include "gl/gl_check.h"

namespace granita::gl {
namespace {

GLuint create() {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    return name;
}

}  // namespace

Buffer::Buffer(std::size_t size, const void* data, GLbitfield access)
    : m_handle(create()), m_size(size) {
    // Storage of no bytes is an error in OpenGL; an empty list is none for us.
    const auto bytes = static_cast<GLsizeiptr>(std::max<std::size_t>(size, 4));
    glNamedBufferStorage(name(), bytes, size == 0 ? nullptr : data, access);
    check("making a buffer of " + std::to_string(size) + " bytes");
}

void Buffer::bind_storage(GLuint binding) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name());
}

void Buffer::read_bytes(void* out, std::size_t size) const {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    if (size > 0) glGetNamedBufferSubData(name(), 0, static_cast<GLsizeiptr>(size), out);
    check("reading a buffer");
}

void Buffer::copy_from(const Buffer& source, std::size_t to) const {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glCopyNamedBufferSubData(source.name(), name(), 0, static_cast<GLintptr>(to),
                             static_cast<GLsizeiptr>(source.size()));
    check("writing a buffer");
}

}  // namespace granita::gl
