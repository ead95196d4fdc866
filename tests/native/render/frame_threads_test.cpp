// SPDX-License-Identifier: GPL-3.0-or-later
// Whole frames on several threads: what they share is found by the thread sanitizer, if by anybody
// (`./dev test --sanitize thread`); without it these are tests of equality.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "no_new_threads.h"
#include "render/shared_frame.h"

namespace granita {
namespace {

TEST(FrameThreads, no_bit_depends_on_their_number) {
    const Picture alone = render(make_scene(1));
    EXPECT_GT(glm::length(alone.combined[kSize * kSize / 2 + kSize / 2]), 0.1f);
    for (const int threads : {2, 3, 7, 3, 7})
        EXPECT_TRUE(equal(alone, render(make_scene(threads))));
}

TEST(FrameThreads, nor_with_textures_bounces_and_media) {
    const Picture alone = render(make_lit_scene(1));
    EXPECT_TRUE(alone.warnings.empty()) << alone.warnings.front().message;
    for (const int threads : {2, 5}) EXPECT_TRUE(equal(alone, render(make_lit_scene(threads))));
}

TEST(FrameThreads, one_bucket_is_shared_by_all) {
    const auto scene = [](int threads) {
        auto made = make_scene(threads);
        made->options.bucket_size = 128;
        return made;
    };
    const Picture alone = render(scene(1));
    EXPECT_EQ(alone.pieces_shared, 0u);
    // Who takes a piece is the system's to say: a busy machine may need more than one frame.
    std::uint64_t shared = 0;
    for (int round = 0; round < 100 && shared == 0; ++round) {
        const Picture picture = render(scene(6));
        EXPECT_TRUE(equal(alone, picture));
        shared = picture.pieces_shared;
    }
    EXPECT_GT(shared, 0u);
}

TEST(FrameThreads, a_frame_goes_on_with_the_threads_that_can_be_made) {
    const Picture alone = render(make_scene(1));
    const NoNewThreads none;
    const Picture picture = render(make_scene(1024));
    EXPECT_TRUE(equal(alone, picture));
    ASSERT_EQ(picture.warnings.size(), 1u);
    EXPECT_EQ(picture.warnings[0].message, "the system allowed 1 of 1024 threads");
}

TEST(FrameThreads, a_cancelled_frame_ends_on_all_of_them) {
    RenderJob at_once(make_scene(5));
    at_once.cancel();
    EXPECT_THROW(at_once.finish(), Cancelled);
    // Later its own end may come first; that one of them comes is the test.
    for (int round = 0; round < 3; ++round) {
        RenderJob job(make_scene(5));
        job.take_tiles(0.05);
    }
}
TEST(FrameThreads, a_cancelled_frame_is_done_though_nobody_takes_its_tiles) {
    for (int milliseconds = 0; milliseconds < 60; milliseconds += 6) {
        RenderJob job(make_scene(5));
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        job.cancel();
        try {
            job.finish();
        } catch (const Cancelled&) {
        }
        EXPECT_TRUE(job.done());
        EXPECT_TRUE(job.take_tiles(0.0).empty());
    }
}

}  // namespace
}  // namespace granita
