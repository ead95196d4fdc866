// SPDX-License-Identifier: GPL-3.0-or-later
// A copy of what the device made, on its way to the CPU.  Begun in one job of GlThread and waited
// for in a later one, it lets the jobs of other buckets in between: while one bucket's copy is on
// its way, the device draws for the others (docs/decisions/gl.md, "Latency").
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

#include "gl/buffer.h"
#include "gl/texture.h"

namespace granita::gl {

class Readback {
  public:
    Readback() = default;
    /// `size` bytes of a buffer from byte `from` on.
    Readback(const Buffer& source, std::size_t from, std::size_t size);
    /// RGBA floats of a part of a texture without layers, row by row.
    Readback(const Texture& source, const TexelRect& part);

    /// Until the copy is there, and with it all that began before.  On the thread that owns OpenGL,
    /// as the constructors.
    void wait() const;
    /// What was copied.  Any thread, after wait() and while the object lives.
    template <class T>
    std::span<const T> values() const {
        return {static_cast<const T*>(m_memory), m_buffer.size() / sizeof(T)};
    }

  private:
    explicit Readback(std::size_t size);
    void send();

    struct Forget {
        void operator()(GLsync sync) const;
    };
    Buffer m_buffer;
    const void* m_memory = nullptr;
    std::unique_ptr<std::remove_pointer_t<GLsync>, Forget> m_sent;
};

}  // namespace granita::gl
