// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/shadow_catchers.h"

#include <cmath>
#include <utility>

#include "math/luminance.h"

namespace granita {
namespace {

/// What is of the plate: everything else is there, as grids name it by index, but no ray meets it
/// and no material shines.
Scene plate(const Scene& scene) {
    Scene plate;
    plate.options = scene.options;
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

/// The grid with the light that it has found in the plate, none to begin with.
Grid in_plate(const Grid& grid, GridLight found = {}) {
    Grid alone = grid;
    alone.found = std::move(found);
    alone.found_alone.reset();
    alone.channels.clear();
    return alone;
}

/// 1 where the plate has no light, as in Cycles.
void divide(std::vector<Vec3f>& light, const std::vector<Vec3f>& alone) {
    for (std::size_t i = 0; i < light.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float left = light[i][c] / alone[i][c];
            light[i][c] = std::isfinite(left) ? left : 1.0f;
        }
}

}  // namespace

ShadowCatchers::ShadowCatchers(const Scene& scene, Statistics& statistics, const Progress& progress)
    : m_scene(plate(scene)), m_shading(m_scene, statistics, m_unsaid, progress, false) {}

void ShadowCatchers::divide(Grid& grid, const ChannelSet& channels, std::span<float> noise,
                            std::span<LampSight> sights) const {
    Grid alone = in_plate(grid);
    alone.radiance.clear();
    m_shading.shade_radiance(alone);
    granita::divide(grid.radiance, alone.radiance);
    fill_caught(grid, channels);
    const std::vector<std::uint32_t>& anchors = grid.shading_positions.anchors;
    const auto at = [&](std::size_t point) {
        return alone.radiance[anchors.empty() ? point : anchors[point]];
    };
    for (std::size_t i = 0; i < noise.size(); ++i) {
        const float part = noise[i] / luminance(at(i));
        noise[i] = std::isfinite(part) ? part : 0.0f;
    }
    for (LampSight& sight : sights)
        for (std::size_t i = 0; i < sight.light.size(); ++i) {
            const Vec3f part = sight.light[i] / at(i);
            for (int c = 0; c < 3; ++c) sight.light[i][c] = std::isfinite(part[c]) ? part[c] : 0.0f;
        }
    grid.found_alone = std::move(alone.found);
}

void ShadowCatchers::divide(Grid& samples, const Grid& grid, std::span<const RefinedPoint> wanted,
                            const ChannelSet& channels) const {
    const Grid alone = in_plate(grid, *grid.found_alone);
    granita::divide(samples.radiance, m_shading.refine(alone, wanted).radiance);
    fill_caught(samples, channels);
}

}  // namespace granita
