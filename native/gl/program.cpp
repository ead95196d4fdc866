// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/program.h"

#include <iomanip>
#include <sstream>

#include "base/error.h"
#include "gl/gl_check.h"

namespace granita::gl {
namespace {

void destroy_shader(GLuint name) {
    glDeleteShader(name);
}
using Shader = Handle<&destroy_shader>;

std::string numbered(const std::string& source) {
    std::istringstream lines(source);
    std::ostringstream out;
    int number = 1;
    for (std::string line; std::getline(lines, line); ++number)
        out << std::setw(4) << number << "  " << line << "\n";
    return out.str();
}

template <class GetIv, class GetLog>
std::string info_log(GLuint name, GetIv get_iv, GetLog get_log) {
    GLint length = 0;
    get_iv(name, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(length), '\0');
    if (length > 0) get_log(name, length, &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return log;
}

const char* stage_name(GLenum type) {
    switch (type) {
        case GL_VERTEX_SHADER:
            return "vertex shader";
        case GL_FRAGMENT_SHADER:
            return "fragment shader";
        case GL_COMPUTE_SHADER:
            return "compute shader";
        default:
            return "shader";
    }
}

Shader compile(const std::string& program_name, const Stage& stage) {
    Shader shader(glCreateShader(stage.type));
    const GLchar* text = stage.source.c_str();
    glShaderSource(shader.name(), 1, &text, nullptr);
    glCompileShader(shader.name());
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        throw GlError(program_name + ": the " + stage_name(stage.type) + " does not compile\n" +
                      info_log(shader.name(), glGetShaderiv, glGetShaderInfoLog) +
                      numbered(stage.source));
    }
    return shader;
}

}  // namespace

Program::Program(const std::string& name, const std::vector<Stage>& stages)
    : m_handle(glCreateProgram()) {
    std::vector<Shader> shaders;
    for (const Stage& stage : stages) {
        shaders.push_back(compile(name, stage));
        glAttachShader(m_handle.name(), shaders.back().name());
    }
    glLinkProgram(m_handle.name());
    for (const Shader& shader : shaders) glDetachShader(m_handle.name(), shader.name());
    GLint linked = GL_FALSE;
    glGetProgramiv(m_handle.name(), GL_LINK_STATUS, &linked);
    if (!linked) {
        std::string message = name + ": the program does not link\n" +
                              info_log(m_handle.name(), glGetProgramiv, glGetProgramInfoLog);
        for (const Stage& stage : stages) message += numbered(stage.source);
        throw GlError(message);
    }
    check("making program '" + name + "'");
}

}  // namespace granita::gl
