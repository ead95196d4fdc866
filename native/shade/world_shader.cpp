// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/world_shader.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "shade/nodes/surface_run.h"

namespace granita {
namespace {

/// Nodes of which nothing is narrower than what they are given: images, and sums of them.  What
/// draws, as comparisons do, may be.
bool is_smooth(const Node& node) {
    static constexpr std::string_view kSmooth[] = {
        "ShaderNodeTexEnvironment", "ShaderNodeTexImage",   "ShaderNodeTexCoord",
        "ShaderNodeMapping",        "ShaderNodeBackground", "ShaderNodeRGB",
        "ShaderNodeValue",          "ShaderNodeGamma",      "ShaderNodeHueSaturation",
        "ShaderNodeBrightContrast", "ShaderNodeInvert",     "ShaderNodeMixShader",
        "ShaderNodeAddShader",      "ShaderNodeLightPath",  "ShaderNodeVectorRotate",
        "ShaderNodeEmission"};
    return std::ranges::find(kSmooth, node.type) != std::end(kSmooth);
}

bool is_visible(const World& world, RayType ray) {
    switch (ray) {
        case RayType::Camera:
            return world.visible_camera;
        case RayType::Diffuse:
            return world.visible_diffuse;
        case RayType::Transmission:
        case RayType::Clear:
            return world.visible_transmission;
        case RayType::Translucent:  // as Cycles: hidden from it by either
            return world.visible_diffuse && world.visible_transmission;
        case RayType::Scattered:
            return world.visible_volume;
        default:
            return world.visible_glossy;
    }
}

}  // namespace

WorldShader::WorldShader(const Scene& scene, TextureStore& textures, Report& report) {
    const NodeGraph& graph = scene.world.graph;
    const GraphOwner owner{"world '" + scene.world.name + "'", true};
    std::vector<RayType> seeing;
    std::ranges::copy_if(kSeeingRays, std::back_inserter(seeing),
                         [&](RayType ray) { return is_visible(scene.world, ray); });
    m_programs.emplace_back();  // of rays that do not see the world: it sends nothing
    for (const RayType ray : seeing) {
        std::size_t& program = m_program_of[static_cast<std::size_t>(ray)];
        const RayType alike = first_alike(graph, ray, seeing);
        if (alike != ray) {
            program = m_program_of[static_cast<std::size_t>(alike)];
            continue;
        }
        program = m_programs.size();
        Report warnings;
        m_programs.push_back(
            compile_surface(graph, scene, textures, warnings, owner, nullptr, ray).radiance);
        report.add_new(warnings);
    }
    m_reads_images = std::any_of(graph.nodes.begin(), graph.nodes.end(), [](const Node& node) {
        return node.type == "ShaderNodeTexEnvironment" || node.type == "ShaderNodeTexImage";
    });
    m_is_smooth = std::ranges::all_of(graph.nodes, is_smooth);
    // One that varies is tabled where it lights, and what is not finite found there.
    const auto is_broken = [&](RayType ray) {
        return is_constant(ray) && !is_finite(emission(ray).constant);
    };
    if (std::ranges::any_of(seeing, is_broken))
        report.warn(owner.name, "is not finite: it is black");
}

const SurfaceProgram& WorldShader::program(RayType ray) const {
    return m_programs[m_program_of[static_cast<std::size_t>(ray)]];
}

void WorldShader::evaluate(const std::vector<Vec3f>& directions, std::span<const Vec2f> rasters,
                           float spread, RayType ray, std::vector<Vec3f>& out) const {
    const VectorSource& source = emission(ray);
    if (source.is_constant()) {
        out.assign(directions.size(), source.constant);
        if (ray == RayType::Camera) make_finite(out);
        return;
    }
    ShadingPoints points;
    points.count = directions.size();
    points.p = directions;
    ShadingInput input;
    input.points = &points;
    input.spread = spread;
    input.rasters = rasters;
    const Program& nodes = program(ray).program;
    Run run = nodes.prepare(input, points.count);
    nodes.execute(run);
    const Column<Vec3f> values = run.read(source);
    out.resize(points.count);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = values[i];
    // Those of light are counted where they are tabled (lights/environment.h).
    if (ray == RayType::Camera) make_finite(out);
}

WorldEvaluator WorldShader::evaluator() const {
    WorldEvaluator world;
    world.radiance = [this](const std::vector<Vec3f>& directions, float spread, RayType ray,
                            std::vector<Vec3f>& out) { radiance(directions, spread, ray, out); };
    world.is_constant =
        std::ranges::all_of(kLightRays, [this](RayType ray) { return is_constant(ray); });
    world.by_lobe = std::ranges::any_of(
        kLightRays, [this](RayType ray) { return &program(ray) != &program(RayType::Diffuse); });
    world.is_filtered = m_reads_images;
    world.is_image = m_reads_images && m_is_smooth;
    return world;
}

}  // namespace granita
