// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/program.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "gl/buffer.h"
#include "gl/egl_context.h"
#include "gl/framebuffer.h"
#include "gl/query.h"
#include "gl/shader_source.h"
#include "gl/texture.h"
#include "gl/vertex_array.h"

namespace granita::gl {
namespace {

constexpr char kPass[] =
    "#version 450 core\n"
    "layout(location = 0) in vec2 p;\n"
    "void main() { gl_Position = vec4(p, 0.5, 1.0); }\n";
constexpr char kGreen[] =
    "#version 450 core\n"
    "layout(location = 0) out vec4 color;\n"
    "void main() { color = vec4(0.0, 2.5, 0.0, 1.0); }\n";

TEST(Program, compile_error_carries_the_numbered_source) {
    const EglContext context;
    try {
        const Program program("test program", {{GL_FRAGMENT_SHADER,
                                                "#version 450 core\n"
                                                "out vec4 color;\n"
                                                "void main() { color = undeclared_name; }\n"}});
        FAIL() << "no exception";
    } catch (const GlError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("test program"), std::string::npos) << text;
        EXPECT_NE(text.find("fragment shader"), std::string::npos) << text;
        EXPECT_NE(text.find("   3  void main() { color = undeclared_name; }"), std::string::npos)
            << text;
        // The driver's log comes first and names it too.
        EXPECT_LT(text.find("undeclared_name"), text.find("   3  ")) << text;
    }
}

TEST(Program, link_error_names_the_program) {
    const EglContext context;
    const std::string fragment =
        "#version 450 core\nin vec3 never_written;\nout vec4 color;\n"
        "void main() { color = vec4(never_written, 1.0); }\n";
    try {
        const Program program("unlinkable",
                              {{GL_VERTEX_SHADER, kPass}, {GL_FRAGMENT_SHADER, fragment}});
        FAIL() << "no exception";
    } catch (const GlError& error) {
        EXPECT_NE(std::string(error.what()).find("unlinkable: the program does not link"),
                  std::string::npos)
            << error.what();
    }
}

TEST(ShaderSource, refuses_unknown_files_and_puts_defines_after_the_version) {
    EXPECT_THROW(embedded_text("no/such.file"), GlError);
    const std::string source = shader_source("resolve/screen.vert", {{"ANSWER", "42"}});
    EXPECT_EQ(source.rfind("#version 450 core\n#define ANSWER 42\n", 0), 0u) << source;
}

TEST(Drawing, fills_a_float_target_and_counts_samples_and_primitives) {
    const EglContext context;
    const Program program("green", {{GL_VERTEX_SHADER, kPass}, {GL_FRAGMENT_SHADER, kGreen}});
    const Texture color(GL_RGBA32F, 8, 4);
    const Texture depth(GL_DEPTH_COMPONENT32F, 8, 4);
    const Framebuffer target(&color, &depth);
    // The left half as two triangles.
    const Buffer corners = Buffer::of(std::vector<float>{-1, -1, 0, -1, 0, 1, -1, 1});
    const Buffer indices = Buffer::of(std::vector<GLuint>{0, 1, 2, 0, 2, 3});
    const VertexArray array;
    array.set_floats(0, corners, 2);
    array.set_indices(indices);

    target.bind();
    glViewport(0, 0, 8, 4);
    const float black[4] = {0, 0, 0, 0};
    glClearNamedFramebufferfv(target.name(), GL_COLOR, 0, black);
    array.bind();
    program.use();
    const Query samples(GL_SAMPLES_PASSED), primitives(GL_PRIMITIVES_GENERATED);
    samples.begin();
    primitives.begin();
    glDrawElements(GL_TRIANGLES, 6, GL_UNSIGNED_INT, nullptr);
    primitives.end();
    samples.end();
    EXPECT_EQ(samples.result(), 16u);
    EXPECT_EQ(primitives.result(), 2u);

    const auto texels = color.read<float>({2, 1, 4, 2}, GL_RGBA, 4);
    ASSERT_EQ(texels.size(), 32u);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x)
            EXPECT_EQ(texels[4 * (4 * y + x) + 1], x < 2 ? 2.5f : 0.0f) << x << ", " << y;
}

TEST(Texture, beyond_the_limit_is_an_error_that_names_the_size) {
    const EglContext context;
    try {
        const Texture texture(GL_RGBA32F, 1 << 20, 4);
        FAIL() << "no exception";
    } catch (const GlError& error) {
        EXPECT_NE(std::string(error.what()).find("1048576 x 4"), std::string::npos) << error.what();
    }
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(Buffer, of_nothing_is_allowed) {
    const EglContext context;
    EXPECT_TRUE(Buffer::of(std::vector<float>{}).read<float>().empty());
}

}  // namespace
}  // namespace granita::gl
