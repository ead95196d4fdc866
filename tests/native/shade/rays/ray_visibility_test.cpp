// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_visibility.h"

#include <gtest/gtest.h>

#include "shade/lights/light_scene.h"
#include "shade/rays/ray_scene.h"

namespace granita {
namespace {

GeometryData square() {
    return quads("mesh 'Square'", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
}

TEST(RayVisibility, what_is_met_and_what_passes_go_by_the_kind_of_ray) {
    // One that is clear to shadow rays alone, behind it one that gloss does not see.
    Scene scene = empty_scene();
    scene.options.bounces.most = 1;
    scene.materials.resize(1);
    const std::size_t pane = add_instance(scene, square(), at({0, 0, 1}));
    scene.instances[pane].materials = {0};
    scene.instances[add_instance(scene, square(), at({0, 0, 2}))].visible_glossy = false;
    RayMaterials opacity;
    opacity.is_transparent = [](std::int32_t material) { return material == 0; };
    opacity.transparency = [](const RayHit&, RayType ray) {
        return Vec3f(ray == RayType::Shadow ? 1.0f : 0.25f);
    };
    const Progress progress;
    const RayScene rays(scene, Vec3d(0.0), opacity, progress);
    const auto left = [&](RayType type, float distance) {
        return rays.transmittance({{0.3f, 0.2f, 0}, {0, 0, 1}, distance, 0.5f, -1, type});
    };
    EXPECT_EQ(left(RayType::Shadow, 1.5f), Vec3f(1.0f));
    EXPECT_EQ(left(RayType::Shadow, 3.0f), Vec3f(0.0f));
    for (const RayType type : {RayType::Glossy, RayType::Singular})
        EXPECT_EQ(left(type, 3.0f), Vec3f(0.25f));
    EXPECT_EQ(left(RayType::Diffuse, 3.0f), Vec3f(0.0f));
}

}  // namespace
}  // namespace granita
