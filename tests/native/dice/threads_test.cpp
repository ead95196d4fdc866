// SPDX-License-Identifier: GPL-3.0-or-later
// The same grids whoever asks, in which order and from how many threads (decision 1).
#include <algorithm>
#include <thread>

#include "dice/dice_scene.h"

namespace granita::testing {
namespace {

TEST(Threads, any_thread_gets_the_same_bits_and_opened_instances_outlive_their_owner) {
    for (const bool subdivided : {false, true}) {
        GeometryData data = cube(50.0f);
        data.is_subdivision = subdivided;
        DiceScene s(data, 1.0f, 64);
        const auto serial = s.grids();
        // Both instances of one geometry are opened by four threads at once.
        s.scene.instances.push_back(s.scene.instances[0]);
        s.view.geometries = std::make_shared<GeometryCache>();
        std::vector<std::vector<std::unique_ptr<Grid>>> found(4);
        std::vector<std::thread> threads;
        for (std::size_t t = 0; t < 4; ++t)
            threads.emplace_back([&, t] {
                auto opened = open_instance(s.view, t % 2, s.report);
                std::vector<std::unique_ptr<Primitive>> primitives;
                for (std::size_t i = 0; i < opened->primitive_count(); ++i)
                    primitives.push_back(opened->primitive(i));
                opened.reset();  // primitives hold on to what they need
                if (t >= 2) std::reverse(primitives.begin(), primitives.end());
                std::vector<std::vector<std::unique_ptr<Grid>>> parts(primitives.size());
                for (std::size_t i = 0; i < primitives.size(); ++i)
                    DiceScene::dice_all(*primitives[i], parts[i]);
                if (t >= 2) std::reverse(parts.begin(), parts.end());
                for (auto& part : parts)
                    for (auto& grid : part) found[t].push_back(std::move(grid));
            });
        for (std::thread& thread : threads) thread.join();
        for (const auto& grids : found) {
            ASSERT_EQ(grids.size(), serial.size());
            for (std::size_t i = 0; i < grids.size(); ++i) {
                EXPECT_EQ(grids[i]->key, serial[i]->key);
                EXPECT_EQ(grids[i]->positions, serial[i]->positions);
                EXPECT_EQ(grids[i]->normal, serial[i]->normal);
                EXPECT_EQ(grids[i]->dp_du, serial[i]->dp_du);
            }
        }
    }
}

}  // namespace
}  // namespace granita::testing
