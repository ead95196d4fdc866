// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/query.h"

#include "gl/gl_check.h"

namespace granita::gl {
namespace {

GLuint create(GLenum target) {
    GLuint name = 0;
    glCreateQueries(target, 1, &name);
    return name;
}

}  // namespace

Query::Query(GLenum target) : m_target(target), m_handle(create(target)) {}

std::uint64_t Query::result() const {
    GLuint64 count = 0;
    glGetQueryObjectui64v(m_handle.name(), GL_QUERY_RESULT, &count);
    check("reading a query");
    return count;
}

}  // namespace granita::gl
