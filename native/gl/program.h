// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "gl/handle.h"

namespace granita::gl {

struct Stage {
    GLenum type;         ///< GL_VERTEX_SHADER, ...
    std::string source;  ///< complete, see shader_source()
};

/// A linked program.  Compile and link failures throw GlError with the driver's log and the source
/// with numbered lines, because the line numbers of a log mean nothing to its reader otherwise.
class Program {
  public:
    Program() = default;
    Program(const std::string& name, const std::vector<Stage>& stages);

    void use() const { glUseProgram(m_handle.name()); }
    GLuint name() const { return m_handle.name(); }

  private:
    static void destroy(GLuint name) { glDeleteProgram(name); }
    Handle<&Program::destroy> m_handle;
};

}  // namespace granita::gl
