// SPDX-License-Identifier: GPL-3.0-or-later
// Lists side by side against lists by themselves: what is left of them, and in which order.
#include "hider/fragment_lists.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <random>

#include "hider/grid_builder.h"
#include "hider/sample_lists.h"

namespace granita::test {
namespace {

constexpr std::uint32_t kSlots = 64;

/// Ids of one grid, so that ties go to the smaller.
bool nearer(float key_a, SurfaceId a, float key_b, SurfaceId b) {
    return key_a != key_b ? key_a > key_b : a < b;
}

/// Lists of `least` to `most` fragments in any order, with as many ties as keys allow.
struct Lists {
    Grid grid = rectangle(0, 0, 200, 1, 1, 200, 1);
    GridPool pool;
    Arena memory;
    FragmentLists lists;
    std::vector<std::vector<Fragment>> alone = std::vector<std::vector<Fragment>>(kSlots);
    std::vector<float> key = std::vector<float>(kSlots, -INFINITY);
    std::vector<SurfaceId> id = std::vector<SurfaceId>(kSlots, kNoSurface);

    Lists(unsigned seed, int least, int most) {
        pool.add(grid);
        lists.prepare(kSlots, memory);
        std::mt19937 random(seed);
        const auto number = [&](int lo, int hi) {
            return std::uniform_int_distribution<int>(lo, hi)(random);
        };
        for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
            std::vector<SurfaceId> ids(200);
            for (SurfaceId i = 0; i < 200; ++i) ids[i] = i;
            std::shuffle(ids.begin(), ids.end(), random);
            const int count = number(least, most);
            for (int k = 0; k < count; ++k) {
                const auto weight = static_cast<float>(k) / 256;
                alone[slot].push_back(
                    {static_cast<float>(number(1, 40)), ids[k], weight, 1 - weight, k % 2 == 0});
                lists.add(slot, alone[slot].back());
            }
            if (number(0, 2) > 0) continue;
            key[slot] = static_cast<float>(number(1, 40));
            if (number(0, 1)) id[slot] = ids[199];
        }
    }

    void expect_sorted() {
        sort_lists(lists, {key.data(), id.data()}, pool, {});
        for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
            std::vector<Fragment>& list = alone[slot];
            std::erase_if(list, [&](const Fragment& f) {
                return f.key < key[slot] ||
                       (f.key == key[slot] && (id[slot] == kNoSurface || id[slot] < f.id));
            });
            std::sort(list.begin(), list.end(), [](const Fragment& a, const Fragment& b) {
                return nearer(a.key, a.id, b.key, b.id);
            });
            ASSERT_EQ(lists.counts()[slot], list.size());
            for (std::uint32_t k = 0; k < list.size(); ++k) {
                ASSERT_EQ(lists.at(slot, k).id, list[k].id);
                ASSERT_EQ(lists.at(slot, k).key, list[k].key);
                ASSERT_EQ(lists.at(slot, k).signed_b1, list[k].signed_b1);
                ASSERT_EQ(lists.at(slot, k).b2, list[k].b2);
            }
        }
    }
};

TEST(FragmentLists, AreSortedAndLoseWhatIsHidden) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        Lists(1, 0, 3).expect_sorted();
        Lists(2, 0, 40).expect_sorted();
        Lists(3, 60, 190).expect_sorted();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(FragmentLists, GiveTheirMemoryBack) {
    Lists some(4, 20, 100);
    EXPECT_GE(some.memory.bytes(), some.lists.total() * sizeof(Fragment));
    some.lists.clear();
    EXPECT_EQ(some.memory.bytes(), 0u);
    EXPECT_EQ(some.lists.total(), 0u);
    some.lists.add(7, {1, 0, 0.5f, 0.5f, true});
    EXPECT_EQ(some.lists.at(7, 0).signed_b1, -0.5f);
}

}  // namespace
}  // namespace granita::test
