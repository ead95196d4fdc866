// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shadow_catchers.h"

namespace granita {
namespace {

/// What is of the plate: everything else is there, as grids name it by index, but no ray meets it
/// and no material shines.
Scene plate(const Scene& scene) {
    Scene plate;
    plate.options = scene.options;
    plate.options.passes.clear();
    plate.options.aovs.clear();
    plate.camera = scene.camera;
    for (std::size_t g = 0; g < scene.geometries.size(); ++g) {
        plate.geometries.emplace_back();
        plate.geometries.adopt(g, scene.geometries, g);
    }
    plate.instances = scene.instances;
    plate.instance_values = scene.instance_values;
    plate.images = scene.images;
    plate.world = scene.world;
    plate.receives_in_volumes = scene.receives_in_volumes;
    plate.materials.resize(scene.materials.size());
    for (Instance& instance : plate.instances) {
        if (!instance.shadow_catcher) {
            instance.visible_camera = instance.visible_diffuse = instance.visible_glossy = false;
            instance.visible_transmission = instance.visible_volume = false;
            instance.casts_shadow = false;
            continue;
        }
        instance.shadow_catcher = false;
        for (const std::int32_t m : instance.materials)
            if (m >= 0) plate.materials[static_cast<std::size_t>(m)] = scene.materials[m];
    }
    for (Light light : scene.lights) {
        if (!light.lights_catchers) {
            light.energy = 0.0f;
            light.energy_knots.clear();
        }
        plate.lights.push_back(std::move(light));
    }
    return plate;
}

/// 1 where neither is any light.
void divide(std::vector<Vec3f>& light, const std::vector<Vec3f>& alone) {
    for (std::size_t i = 0; i < light.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float most = std::max(alone[i][c], std::numeric_limits<float>::min());
            light[i][c] = light[i][c] == alone[i][c] ? 1.0f : light[i][c] / most;
        }
}

}  // namespace

ShadowCatchers::ShadowCatchers(const Scene& scene, Statistics& statistics, const Progress& progress)
    : m_scene(plate(scene)), m_shading(m_scene, statistics, m_unsaid, progress) {}

void ShadowCatchers::divide(Grid& grid, const ChannelSet& channels) const {
    auto alone = std::make_shared<Grid>(grid);
    for (auto* values : {&alone->radiance, &alone->gathered, &alone->gathered_world,
                         &alone->scattered, &alone->scattered_bounced})
        values->clear();
    alone->channels.clear();
    m_shading.shade_radiance(*alone);
    granita::divide(grid.radiance, alone->radiance);
    fill_caught(grid, channels);
    grid.lit_alone = std::move(alone);
}

void ShadowCatchers::divide(Grid& samples, const Grid& grid, std::span<const RefinedPoint> wanted,
                            const ChannelSet& channels) const {
    granita::divide(samples.radiance, m_shading.refine(*grid.lit_alone, wanted).radiance);
    fill_caught(samples, channels);
}

}  // namespace granita
