// SPDX-License-Identifier: GPL-3.0-or-later
// What the grids of a frame are shaded with: materials compiled, the light that they see, all made
// once.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "base/statistics.h"
#include "scene/channels.h"
#include "scene/scene.h"
#include "scene/shutter_warp.h"
#include "shade/bounces/bounced_light.h"
#include "shade/bounces/hit_shader.h"
#include "shade/lights/direct_light.h"
#include "shade/material_displacement.h"
#include "shade/moving_eye.h"
#include "shade/nodes/material_emission.h"
#include "shade/nodes/node_compiler.h"
#include "shade/persistent_shading.h"
#include "shade/programs/shading_camera.h"
#include "shade/seen_volumes.h"
#include "shade/shadow_catchers.h"
#include "shade/subsurface/subsurface_light.h"
#include "shade/textures/texture.h"
#include "shade/unsettled.h"
#include "shade/world_shader.h"

namespace granita {

struct FrameShading {
    const Scene& scene;
    Statistics& statistics;
    Report& report;
    const Progress& progress;
    TextureStore textures;
    ShadingCamera camera;
    MovingEye eye;
    ShutterWarp shutter;
    ChannelSet channels;
    std::vector<CompiledSurface> materials;  ///< [materials + 1]
    std::vector<std::vector<AttributeRequest>> requests;
    std::unique_ptr<MaterialEmission> emission;
    std::unique_ptr<MaterialDisplacement> displacement;  ///< nullptr: nothing is displaced
    WorldShader world;
    bool refines;
    bool moves;  ///< anything of the frame
    UnsettledThresholds thresholds;
    float footprint;  ///< of a sample, in steps of a grid
    std::shared_ptr<GeometryCache> geometries;
    std::shared_ptr<const ShadedGrids> shaded;  ///< of an earlier picture, or nullptr
    std::unique_ptr<Volumes> volumes;           ///< nullptr where nothing is filled
    std::unique_ptr<SeenVolumes> seen_volumes;  ///< likewise
    std::unique_ptr<DirectLight> light;         ///< nullptr where nothing that is seen reflects any
    std::unique_ptr<HitShader> hits;            ///< where light is followed or its rays told apart
    std::unique_ptr<BouncedLight> bounces;
    std::unique_ptr<SubsurfaceLight> below;    ///< where light is scattered below surfaces
    std::unique_ptr<ShadowCatchers> catchers;  ///< nullptr: there are none

    /// Of ShadingSystem's.
    FrameShading(const Scene& s, Statistics& stats, Report& warnings, const Progress& p,
                 bool refines_samples, const PersistentShading& kept);

    const CompiledSurface& material(int index) const {
        return index < 0 ? materials.back() : materials[index];
    }
    bool reflects(std::int32_t index) const { return material(index).radiance.sources.reflects(); }
    /// Whether what it shows goes by attributes alone: neither by light nor by where its points
    /// are.
    bool is_painted(std::int32_t index) const {
        return !reflects(index) && material(index).radiance.program.is_still();
    }
    bool scatters(std::int32_t index) const { return material(index).radiance.scatters(); }
    const NodeGraph& graph_of(std::int32_t index) const {
        return scene.materials[static_cast<std::size_t>(index)].graph;
    }
    /// Whether it is so of any material of any instance.
    bool any(const std::function<bool(std::int32_t)>& is) const {
        return std::ranges::any_of(scene.instances, [&](const Instance& i) {
            return std::ranges::any_of(i.materials, is);
        });
    }
    void warn_of_broken(std::int32_t index, std::size_t count) const;

  private:
    RayMaterials ray_materials() const;
};

}  // namespace granita
