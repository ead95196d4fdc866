// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/dearest_objects.h"

#include <gtest/gtest.h>

namespace granita {
namespace {

TEST(DearestObjectsTest, instances_of_a_name_count_together_and_the_dearest_come_first) {
    Scene scene;
    for (const char* name : {"Tree", "Stone", "Tree", "Unseen", "Cloud"})
        scene.instances.emplace_back().name = name;
    ObjectCosts costs(scene.instances.size());
    costs.add_seconds(0, 0.25);
    costs.add_seconds(1, 0.375);
    costs.add_seconds(2, 0.25);
    costs.add_seconds(4, 0.125);
    costs.add_micropolygons(0, 3);
    costs.add_micropolygons(2, 4);
    costs.add_seconds(5, 1.0);  // of no object
    EXPECT_EQ(dearest_objects(scene, costs, 2),
              (std::vector<DearObject>{{"Tree", 0.5, 7}, {"Stone", 0.375, 0}}));
    EXPECT_EQ(dearest_objects(scene, costs, 9).size(), 3u);
}

}  // namespace
}  // namespace granita
