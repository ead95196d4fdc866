// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/egl_context.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "base/error.h"
#include "gl/buffer.h"
#include "gl/gl_check.h"
#include "gl/gl_thread.h"

namespace granita::gl {
namespace {

TEST(EglContext, needs_no_display_and_offers_4_5_core) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    const EglContext context;
    GLint major = 0, minor = 0, profile = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_GE(10 * major + minor, 45);
    EXPECT_TRUE(profile & GL_CONTEXT_CORE_PROFILE_BIT);
    EXPECT_FALSE(context.info().renderer.empty());
    EXPECT_GE(context.info().max_texture_size, 4096);
}

TEST(EglContext, two_in_turn_keep_their_own_objects) {
    EglContext first;
    const Buffer in_first(4, nullptr);
    {
        EglContext second;
        EXPECT_FALSE(glIsBuffer(in_first.name()));
        const Buffer in_second(16, nullptr);
        EXPECT_TRUE(glIsBuffer(in_second.name()));
    }
    first.make_current();
    EXPECT_TRUE(glIsBuffer(in_first.name()));
    check("after the second context");
}

TEST(EglContext, objects_that_outlive_it_do_no_harm) {
    Buffer orphan;
    {
        const EglContext context;
        orphan = Buffer(4, nullptr);
        EXPECT_NE(orphan.name(), 0u);
    }
    EXPECT_NO_THROW(orphan = Buffer());
    const EglContext context;
    check("in the next context");
}

TEST(EglContext, says_whether_it_is_software) {
    const EglContext context;
    if (context.info().renderer.find("llvmpipe") != std::string::npos) {
        EXPECT_TRUE(context.info().software);
    }
    if (!context.info().software) {
        EXPECT_NO_THROW(EglContext({.device = DeviceChoice::Hardware}));
    } else {
        EXPECT_THROW(EglContext({.device = DeviceChoice::Hardware}), GlError);
    }
}

TEST(Check, names_the_error_and_the_step) {
    EglContext context({.debug = true});
    glEnable(GL_TEXTURE_2D + 12345);
    try {
        check("switching on nonsense");
        FAIL() << "no exception";
    } catch (const GlError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("switching on nonsense"), std::string::npos) << text;
        EXPECT_NE(text.find("GL_INVALID_ENUM"), std::string::npos) << text;
        EXPECT_NE(text.find("\n  "), std::string::npos)
            << "the driver's message is missing: " << text;
    }
    EXPECT_NO_THROW(check("afterwards"));
}

TEST(Check, a_missing_entry_point_throws_and_does_not_abort) {
    const EglContext context;
    if (epoxy_has_gl_extension("GL_NV_command_list")) GTEST_SKIP() << "the driver has this one";
    GLuint states = 0;
    glCreateStatesNV(1, &states);
    try {
        check("a call without provider");
        FAIL() << "no exception";
    } catch (const GlError& error) {
        EXPECT_NE(std::string(error.what()).find("glCreateStatesNV"), std::string::npos);
    }
    EXPECT_NO_THROW(check("afterwards"));
}

// A machine without any driver, in a process of its own because EGL reads its vendors once.
TEST(EglContextDeathTest, no_driver_is_an_error_not_an_abort) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent", 1);
            try {
                const GlThread thread;
            } catch (const GlError& error) {
                std::cerr << "GlError: " << error.what() << std::endl;
                std::exit(7);
            }
            std::exit(0);
        },
        testing::ExitedWithCode(7), "GlError: .*EGL");
}

}  // namespace
}  // namespace granita::gl
