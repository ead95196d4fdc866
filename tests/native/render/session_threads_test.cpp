// SPDX-License-Identifier: GPL-3.0-or-later
// A view's pictures one after another, each asked for before the one before has ended: for the
// thread sanitizer as frame_threads_test.cpp.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "render/shared_frame.h"

namespace granita {
namespace {

std::shared_ptr<Scene> adopted(Session& session, std::shared_ptr<Scene> scene) {
    session.adopt(*scene);
    return scene;
}

std::shared_ptr<Scene> seen_from(double x) {
    auto scene = make_lit_scene(3);
    scene->camera.world_from_camera[0][3].x = x;
    return scene;
}

TEST(SessionThreads, no_bit_depends_on_what_is_kept) {
    const auto session = std::make_shared<Session>();
    const Picture alone = render(make_lit_scene(1));
    EXPECT_TRUE(equal(alone, render(adopted(*session, make_lit_scene(3)), session)));
    EXPECT_TRUE(equal(alone, render(adopted(*session, make_lit_scene(4)), session)));
    EXPECT_GT(session->geometries_adopted(), 0u);
}

TEST(SessionThreads, a_picture_begins_while_the_one_before_it_ends) {
    const auto session = std::make_shared<Session>();
    std::unique_ptr<RenderJob> before;
    for (int edit = 0; edit < 8; ++edit) {
        auto job =
            std::make_unique<RenderJob>(adopted(*session, seen_from(edit % 3)), kHardware, session);
        if (before) before->cancel();
        before = std::move(job);  // joins the one before
        std::this_thread::sleep_for(std::chrono::milliseconds(edit * 5));
    }
    before->cancel();
    before.reset();
    const Picture last = render(adopted(*session, seen_from(2.0)), session);
    EXPECT_TRUE(equal(render(seen_from(2.0)), last));
}

}  // namespace
}  // namespace granita
