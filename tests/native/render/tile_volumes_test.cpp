// SPDX-License-Identifier: GPL-3.0-or-later
// What volumes keep of lists of layers: counted, and within what lists may take.
#include "render/tile_volumes.h"

#include <gtest/gtest.h>

#include "render/shared_frame.h"

namespace granita {
namespace {

constexpr int kSheets = 30;
/// Of a bucket: a tile of 256 pixels, each of which sees all sheets.
constexpr std::uint64_t kLayers = 256 * 4 * kSheets;

/// Sheets that let half of the light through, in a fog or in nothing.
std::shared_ptr<Scene> sheets(bool fog, bool channels) {
    auto scene = make_lit_scene(1);
    Options& o = scene->options;
    o.opacity_threshold = 1.0f;
    o.bounces.most = 0;
    o.crop = {16, 16, 32, 32};
    if (channels) o.passes = {"Volume Direct"};
    Material half = lace();
    half.graph.nodes[3].inputs["Fac"] = Vec4f(0.5f);
    scene->materials[1] = half;
    const Instance box = scene->instances.back();
    scene->instances.clear();
    if (fog) scene->instances.push_back(box);
    for (int i = 0; i < kSheets; ++i)
        add(*scene, sheet(1, 10.0f + static_cast<float>(i)), 1, Vec3d(0.0));
    return scene;
}

TEST(TileVolumes, what_they_keep_of_layers_is_counted) {
    const std::uint64_t lists = render(sheets(false, false)).peak_list_bytes;
    EXPECT_GE(lists, kLayers * sizeof(Fragment));
    const std::uint64_t looks = kLayers * (sizeof(LayerLook) + sizeof(std::uint32_t));
    EXPECT_GE(render(sheets(true, false)).peak_list_bytes, kLayers * sizeof(Fragment) + looks);
}

TEST(TileVolumes, what_lies_between_layers_is_kept_for_channels_alone) {
    const Picture without = render(sheets(true, false)), with = render(sheets(true, true));
    EXPECT_EQ(with.peak_list_bytes,
              without.peak_list_bytes + kLayers * (sizeof(SampleVolume) + sizeof(SurfacePoint)));
}

TEST(TileVolumes, where_there_is_no_room_for_them_tiles_are_seen_in_parts) {
    constexpr std::uint64_t kLimit = 1 << 20;
    auto scene = sheets(true, false);
    const Picture whole = render(scene);
    EXPECT_GT(whole.peak_list_bytes, kLimit);
    scene = sheets(true, false);
    scene->options.list_memory = 1;
    const Picture parts = render(scene);
    EXPECT_LE(parts.peak_list_bytes, kLimit);
    EXPECT_TRUE(equal(whole, parts));
}

}  // namespace
}  // namespace granita
