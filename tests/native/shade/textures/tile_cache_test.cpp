// SPDX-License-Identifier: GPL-3.0-or-later
// Tiles leave memory when there is no room, come back as they were, and are never freed under a
// reader.
#include "shade/textures/tile_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include "shade/textures/texture_filter.h"
#include "shade/textures/texture_scene.h"

namespace granita {
namespace {

constexpr TileShape kShape{TexelType::Byte, 64, 64};

std::unique_ptr<Tile> tile_of(int value) {
    auto tile = std::make_unique<Tile>(kShape);
    tile->fill(Vec4f(float(value) / 255.0f));
    return tile;
}

const Tile* seen(TileCache& cache, TileSlot& slot) {
    const Tile* found = slot.look();
    return found ? found : cache.reload(slot, kShape, [] { return tile_of(0); });
}

int value_of(const Tile* tile) {
    return static_cast<int>(tile->texels[kShape.byte_count() - 1]);
}

TEST(TileCache, what_left_memory_comes_back_as_it_was) {
    Report report;
    TileCache cache(4 * kShape.byte_count(), report);
    std::vector<TileSlot> slots(100);
    for (int i = 0; i < 100; ++i) cache.insert(slots[i], tile_of(i), false);
    for (int pass = 0; pass < 2; ++pass)
        for (int i = 0; i < 100; ++i) {
            const TileCache::ReadScope scope(cache);
            ASSERT_EQ(value_of(seen(cache, slots[i])), i);
        }
    int in_memory = 0;
    for (const TileSlot& slot : slots) in_memory += slot.tile.load() != nullptr;
    EXPECT_LE(in_memory, 4);
    EXPECT_TRUE(report.warnings().empty());
}

TEST(TileCache, memory_stays_within_what_is_allowed) {
    Report report;
    const std::uint64_t kLimit = 64 * kShape.byte_count();
    TileCache cache(kLimit, report);
    std::vector<TileSlot> slots(1000);
    for (int i = 0; i < 1000; ++i) {
        cache.insert(slots[i], tile_of(i % 256), false);
        // Those that wait to be freed are freed together, 32 at once.
        ASSERT_LE(cache.byte_count(), kLimit + 33 * kShape.byte_count());
    }
}

TEST(TileCache, a_limit_that_is_lowered_holds_at_once) {
    Report report;
    TileCache cache(1000 * kShape.byte_count(), report);
    std::vector<TileSlot> slots(100);
    for (int i = 0; i < 100; ++i) cache.insert(slots[i], tile_of(i), true);
    ASSERT_EQ(cache.byte_count(), 100 * kShape.byte_count());
    cache.set_limit(10 * kShape.byte_count());
    EXPECT_EQ(cache.byte_count(), 10 * kShape.byte_count());
    const TileCache::ReadScope scope(cache);
    for (int i = 0; i < 100; ++i) ASSERT_EQ(value_of(seen(cache, slots[i])), i);
}

TEST(TileCache, a_tile_that_is_being_read_is_not_freed) {
    Report report;
    TileCache cache(kShape.byte_count(), report);
    std::vector<TileSlot> slots(200);
    cache.insert(slots[0], tile_of(77), false);
    {
        const TileCache::ReadScope scope(cache);
        const Tile* held = slots[0].look();
        for (int i = 1; i < 200; ++i) cache.insert(slots[i], tile_of(i), false);
        EXPECT_EQ(slots[0].tile.load(), nullptr);  // it has left
        EXPECT_EQ(value_of(held), 77);             // and is there
        EXPECT_GE(cache.byte_count(), 199 * kShape.byte_count());
    }
    std::vector<TileSlot> more(64);
    for (TileSlot& slot : more) cache.insert(slot, tile_of(1), false);
    EXPECT_LE(cache.byte_count(), 34 * kShape.byte_count());
}

TEST(TileCache, tiles_that_are_read_stay_longer_than_those_that_are_not) {
    Report report;
    TileCache cache(8 * kShape.byte_count(), report);
    std::vector<TileSlot> slots(500);
    cache.insert(slots[0], tile_of(1), true);
    for (int i = 1; i < 500; ++i) {
        EXPECT_NE(slots[0].look(), nullptr);
        cache.insert(slots[i], tile_of(2), false);
    }
}

TEST(TileCache, without_a_temporary_file_textures_stay_in_memory_and_that_is_said) {
    const char* before = std::getenv("TMPDIR");
    const std::string saved = before ? before : "";
    setenv("TMPDIR", "/nowhere/at/all", 1);
    Report report;
    TileCache cache(kShape.byte_count(), report);
    std::vector<TileSlot> slots(20);
    for (int i = 0; i < 20; ++i) cache.insert(slots[i], tile_of(i), false);
    before ? setenv("TMPDIR", saved.c_str(), 1) : unsetenv("TMPDIR");
    for (int i = 0; i < 20; ++i) EXPECT_EQ(value_of(slots[i].look()), i);
    ASSERT_EQ(report.warnings().size(), 1u);
    EXPECT_EQ(report.warnings()[0].datablock, "textures");
}

// Many threads in little memory: images that are decoded, spilled and read again at once, and one
// whose file is tiled.  Every texel of an image is its own number, so a row that was not written or
// was written elsewhere shows.  Meant for the thread sanitizer too.
TEST(TileCache, many_threads_in_little_memory_see_every_texel_as_it_is) {
    constexpr int kSize = 256, kImages = 6, kThreads = 4;
    const auto number = [](int image, int x, int y) {
        return float((image * 31 + x * 7 + y * 13) % 256);
    };
    std::vector<std::unique_ptr<ImageFile>> files;
    Scene scene;
    for (int i = 0; i < kImages; ++i) {
        files.push_back(std::make_unique<ImageFile>(i % 2 ? ".tif" : ".exr"));
        const auto texel = [&](int, int x, int y) { return number(i, x, y); };
        // Served from their files, decoded from tiles, decoded from rows.
        ASSERT_TRUE(write_image(*files[i], kSize, texel, i < 4 ? 32 : 0, i < 2));
        scene.images.push_back(files[i]->image("Non-Color"));
        scene.images.back().name = std::to_string(i);
    }
    Report report;
    const auto cache = std::make_shared<TileCache>(1 << 20, report);
    const auto open_files = std::make_shared<OpenFiles>(1);
    TextureMode closest;
    closest.filter = TextureFilter::Closest;
    std::vector<std::unique_ptr<TiledImage>> images;
    for (const Image& image : scene.images)
        images.push_back(std::make_unique<TiledImage>(image, read_texture_header(image), false,
                                                      cache, open_files));
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < kThreads; ++t)
        threads.emplace_back([&, t] {
            std::mt19937 random(t);
            for (int k = 0; k < 40; ++k) {
                const int i = static_cast<int>(random() % kImages);
                const int finest = static_cast<int>(random() % 4);  // some ask for coarse ones
                if (!images[i]->make_ready(finest)) ++wrong;
                const TileCache::ReadScope scope(*cache);
                if (finest > 0) {
                    const Vec2f all(1.0f, 0.0f), over(0.0f, 1.0f);
                    const Vec4f seen = filtered(*images[i], {}, {{0.5f, 0.5f}, all, over});
                    if (i >= 2) wrong += std::abs(seen.x - 127.5f) > 0.01f;  // not by its file
                    continue;
                }
                for (int p = 0; p < 64; ++p) {
                    const int x = static_cast<int>(random() % kSize),
                              y = static_cast<int>(random() % kSize);
                    const Vec2f center = (Vec2f(x, y) + 0.5f) / float(kSize);
                    const Vec4f seen = filtered(*images[i], closest, {center, {}, {}});
                    wrong += seen.x != number(i, x, kSize - 1 - y);
                }
            }
        });
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_TRUE(report.warnings().empty());
}

TEST(TileCache, images_that_a_cancelled_frame_wants_are_not_decoded) {
    Report report;
    Statistics statistics;
    Progress progress;
    progress.cancel();
    ImageFile file(".exr");
    ASSERT_TRUE(write_image(
        file, 128, [](int, int, int) { return 0.5f; }, 0, false));
    Scene scene;
    scene.images = {file.image("Non-Color"), image_of_bytes(128, 128, random_blocks(128, 4, 1))};
    scene.images[0].name = "File";
    TextureStore store(scene, statistics, report, &progress);
    std::vector<Vec4f> out;
    for (const Image& image : scene.images) {
        const auto texture = store.find(image.name, "material 'M'");
        for (int reader = 0; reader < 2; ++reader)
            EXPECT_THROW(texture->look_up({}, {{{0.5f, 0.5f}, {}, {}}}, out), Cancelled);
    }
    EXPECT_EQ(store.byte_count(), 0u);
    EXPECT_TRUE(report.warnings().empty());
}

}  // namespace
}  // namespace granita
