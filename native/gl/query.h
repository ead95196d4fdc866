// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "gl/handle.h"

namespace granita::gl {

/// Counts between begin() and end(): GL_SAMPLES_PASSED, GL_PRIMITIVES_GENERATED, GL_TIME_ELAPSED...
/// Queries of one target do not nest.
class Query {
  public:
    explicit Query(GLenum target);
    void begin() const { glBeginQuery(m_target, m_handle.name()); }
    void end() const { glEndQuery(m_target); }
    /// Waits until the device has finished what was counted.
    std::uint64_t result() const;

  private:
    static void destroy(GLuint name) { glDeleteQueries(1, &name); }
    GLenum m_target;
    Handle<&Query::destroy> m_handle;
};

}  // namespace granita::gl
