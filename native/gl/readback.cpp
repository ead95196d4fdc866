// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/readback.h"

#include <string>

#include "gl/gl_check.h"

namespace granita::gl {
namespace {

constexpr GLbitfield kReadInPlace = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

}  // namespace

Readback::Readback(std::size_t size)
    : m_buffer(size, nullptr, kReadInPlace | GL_CLIENT_STORAGE_BIT) {
    if (size == 0) return;  // nothing to map, which OpenGL calls an error
    m_memory =
        glMapNamedBufferRange(m_buffer.name(), 0, static_cast<GLsizeiptr>(size), kReadInPlace);
    check("mapping a buffer of " + std::to_string(size) + " bytes");
}

Readback::Readback(const Buffer& source, std::size_t from, std::size_t size) : Readback(size) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glCopyNamedBufferSubData(source.name(), m_buffer.name(), static_cast<GLintptr>(from), 0,
                             static_cast<GLsizeiptr>(size));
    send();
}

Readback::Readback(const Texture& source, const TexelRect& part)
    : Readback(static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height) * 4 *
               sizeof(float)) {
    source.copy_to(m_buffer, part);
    send();
}

void Readback::send() {
    m_sent.reset(glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0));
    glFlush();
    check("reading back");
}

void Readback::wait() const {
    constexpr GLuint64 kSecond = 1'000'000'000;  // then whether the GPU was lost
    while (glClientWaitSync(m_sent.get(), 0, kSecond) == GL_TIMEOUT_EXPIRED)
        check("waiting for a copy");
    check("waiting for a copy");
}

void Readback::Forget::operator()(GLsync sync) const {
    if (eglGetCurrentContext() != EGL_NO_CONTEXT) glDeleteSync(sync);
}

}  // namespace granita::gl
