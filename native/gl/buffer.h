// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "gl/handle.h"

namespace granita::gl {

/// Memory of the device, of a fixed size in bytes.
class Buffer {
  public:
    Buffer() = default;
    /// Copies `size` bytes from `data`; nullptr leaves them undefined.  `access`: how the CPU may
    /// get at them, bits of glNamedBufferStorage.
    Buffer(std::size_t size, const void* data, GLbitfield access = 0);

    template <class T>
    static Buffer of(const std::vector<T>& values) {
        return Buffer(values.size() * sizeof(T), values.data());
    }
    /// Waits for the device.
    template <class T>
    std::vector<T> read() const {
        std::vector<T> values(m_size / sizeof(T));
        read_bytes(values.data(), values.size() * sizeof(T));
        return values;
    }
    /// Overwrites values from value `first` on.
    template <class T>
    void write(std::size_t first, const std::vector<T>& values) const {
        copy_from(of(values), first * sizeof(T));
    }

    std::size_t size() const { return m_size; }
    GLuint name() const { return m_handle.name(); }
    /// As the shader storage block of that binding.
    void bind_storage(GLuint binding) const;

  private:
    void read_bytes(void* out, std::size_t size) const;
    void copy_from(const Buffer& source, std::size_t to) const;
    static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
    Handle<&Buffer::destroy> m_handle;
    std::size_t m_size = 0;
};

}  // namespace granita::gl
