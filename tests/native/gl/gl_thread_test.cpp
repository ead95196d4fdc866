// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/gl_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>

#include "base/error.h"
#include "gl/buffer.h"
#include "gl/program.h"

namespace granita::gl {
namespace {

TEST(GlThread, carries_results_and_exceptions_and_goes_on) {
    GlThread thread;
    EXPECT_EQ(thread.run([] { return 42; }), 42);
    try {
        thread.run([] { throw SceneError("object 'Cube'", "is broken"); });
        FAIL() << "no exception";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.datablock(), "object 'Cube'");
    }
    EXPECT_FALSE(thread.run([] { return glGetString(GL_VERSION) == nullptr; }));
}

TEST(GlThread, a_broken_shader_does_not_kill_it) {
    GlThread thread;
    EXPECT_THROW(thread.run([] {
        return Program("broken",
                       {{GL_VERTEX_SHADER, "#version 450 core\nvoid main() { nonsense }\n"}})
            .name();
    }),
                 GlError);
    const std::vector<int> values{3, 1, 4, 1, 5};
    EXPECT_EQ(thread.run([&] { return Buffer::of(values).read<int>(); }), values);
}

TEST(GlThread, a_job_may_run_a_job) {
    GlThread thread;
    EXPECT_EQ(thread.run([&] { return thread.run([] { return 7; }) + 1; }), 8);
}

TEST(GlThread, serialises_the_jobs_of_many_threads) {
    GlThread thread;
    int unguarded = 0;  // only the thread that owns OpenGL touches it
    std::vector<std::thread> callers;
    for (int c = 0; c < 4; ++c)
        callers.emplace_back([&] {
            for (int i = 0; i < 250; ++i) thread.run([&] { ++unguarded; });
        });
    for (std::thread& caller : callers) caller.join();
    EXPECT_EQ(thread.run([&] { return unguarded; }), 1000);
}

TEST(GlThread, finishes_what_is_queued_before_it_ends) {
    std::atomic<int> done{0};
    {
        GlThread thread;
        for (int i = 0; i < 10; ++i) thread.submit([&] { ++done; });
    }
    EXPECT_EQ(done, 10);
}

TEST(GlThread, two_at_once_and_one_after_the_other) {
    GlThread first;
    {
        GlThread second;
        EXPECT_NE(second.run([] { return glCreateShader(GL_VERTEX_SHADER); }), 0u);
    }
    EXPECT_NE(first.run([] { return glCreateShader(GL_VERTEX_SHADER); }), 0u);
    GlThread third;
    EXPECT_EQ(third.info().renderer, first.info().renderer);
}

TEST(DeviceClock, tells_what_is_hidden_from_what_is_waited_for) {
    using std::chrono::milliseconds;
    GlThread thread;
    thread.clock().add_worker(1);
    thread.run([] { std::this_thread::sleep_for(milliseconds(20)); });
    const DeviceUse waited = thread.clock().use();
    EXPECT_GE(waited.seconds, 0.02);
    EXPECT_EQ(waited.hidden_seconds, 0.0);  // the only worker waited
    // Another one that works until the job ends.
    thread.clock().add_worker(1);
    thread.run([] { std::this_thread::sleep_for(milliseconds(20)); });
    thread.clock().add_worker(-1);
    const DeviceUse both = thread.clock().use();
    EXPECT_GE(both.hidden_seconds, 0.02);
    EXPECT_GE(both.seconds, waited.seconds + 0.02);
    EXPECT_LE(both.hidden_seconds, both.seconds);
}

}  // namespace
}  // namespace granita::gl
