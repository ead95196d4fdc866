// SPDX-License-Identifier: GPL-3.0-or-later
// Node graphs compiled and run over points: folding, slices, conversions, weights, shifts.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "shade/nodes/node_compiler.h"

namespace granita {
namespace {

struct Compiler {
    Scene scene;
    Statistics statistics;
    Report report;
    TextureStore textures{scene, statistics, report};
    NodeGraph graph;

    int add(const std::string& type, std::map<std::string, NodeInput> inputs,
            std::map<std::string, NodeProperty> properties = {}) {
        graph.nodes.push_back({type, type, std::move(inputs), std::move(properties)});
        return static_cast<int>(graph.nodes.size()) - 1;
    }
    CompiledSurface compile(int surface, const std::string& output) {
        graph.surface = {surface, output};
        return compile_surface(graph, scene, textures, report, {"material 'Test'"});
    }
};

NodeInput constant(float x) {
    return Vec4f(x, 0, 0, 0);
}
NodeInput color(float r, float g, float b) {
    return Vec4f(r, g, b, 1);
}
NodeInput link(int node, const std::string& output) {
    return NodeLink{node, output};
}

/// One attribute of three components at two points, one step along u adds `du`.
std::vector<GridAttribute> attribute(const Vec3f& first, const Vec3f& second, const Vec3f& du) {
    GridAttribute a;
    a.width = 3;
    a.values = {first.x, first.y, first.z, second.x, second.y, second.z};
    a.du = {du.x, du.y, du.z, du.x, du.y, du.z};
    a.dv = std::vector<float>(6, 0.0f);
    return {a};
}

std::vector<Vec3f> run_emission(const CompiledSurface& surface,
                                const std::vector<GridAttribute>& attributes,
                                const ShadingPoints& points = {}) {
    ShadingInput input;
    input.points = &points;
    input.attributes = &attributes;
    Run run = surface.radiance.program.prepare(input, 2);
    surface.radiance.program.execute(run);
    const auto column = run.read(surface.radiance.sources.emission);
    return {column[0], column[1]};
}

TEST(NodeProgram, constant_graphs_fold_to_a_constant) {
    Compiler c;
    const int math = c.add("ShaderNodeMath", {{"Value", constant(2)}, {"Value_001", constant(3)}},
                           {{"operation", std::string("MULTIPLY")}});
    const int emission = c.add("ShaderNodeEmission", {{"Color", color(0.5f, 0.25f, 0)},
                                                      {"Strength", link(math, "Value")}});
    const CompiledSurface surface = c.compile(emission, "Emission");
    EXPECT_EQ(surface.radiance.program.step_count(), 0u);
    EXPECT_TRUE(surface.radiance.sources.emission.is(Vec3f(3.0f, 1.5f, 0.0f)));
}

TEST(NodeProgram, rays_are_asked_by_what_is_read_alone) {
    Compiler c;
    const int occlusion = c.add("ShaderNodeAmbientOcclusion", {}, {{"only_local", 1.0}});
    const int plain = c.add("ShaderNodeEmission", {{"Strength", constant(1)}});
    c.graph.surface = {plain, "Emission"};
    EXPECT_FALSE(asks_rays(c.graph));
    const int shaded = c.add("ShaderNodeEmission", {{"Strength", link(occlusion, "AO")}});
    c.graph.surface = {shaded, "Emission"};
    EXPECT_TRUE(asks_rays(c.graph));
    EXPECT_TRUE(asks_itself(c.graph));
    c.graph.nodes[static_cast<std::size_t>(occlusion)].properties.clear();
    EXPECT_FALSE(asks_itself(c.graph));
    c.graph.surface = {plain, "Emission"};
    c.add("ShaderNodeOutputAOV", {{"Value", link(occlusion, "AO")}});
    EXPECT_TRUE(asks_rays(c.graph));
}

TEST(NodeProgram, opacity_is_one_where_nothing_is_transparent) {
    Compiler c;
    const int diffuse = c.add("ShaderNodeBsdfDiffuse", {{"Color", color(1, 1, 1)}});
    EXPECT_TRUE(c.compile(diffuse, "BSDF").transparency.is(Vec3f(0.0f)));
}

TEST(NodeProgram, opacity_slice_leaves_out_what_only_colour_needs) {
    Compiler c;
    const int texture = c.add("ShaderNodeTexGradient", {});
    const int coordinate = c.add("ShaderNodeTexCoord", {});
    const int alpha = c.add("ShaderNodeSeparateXYZ", {{"Vector", link(coordinate, "Object")}});
    const int principled =
        c.add("ShaderNodeBsdfPrincipled",
              {{"Base Color", link(texture, "Color")}, {"Alpha", link(alpha, "X")}});
    const CompiledSurface surface = c.compile(principled, "BSDF");
    ASSERT_EQ(surface.opacity_program.loads().size(), 1u);
    const int wanted = surface.opacity_program.loads()[0].request;
    EXPECT_EQ(surface.requests[wanted].source, AttributeSource::ObjectPosition);
    EXPECT_GT(surface.radiance.program.step_count(), surface.opacity_program.step_count());
}

TEST(NodeProgram, mix_shader_shares_weight_and_clamps_its_factor) {
    Compiler c;
    const int clear = c.add("ShaderNodeBsdfTransparent", {{"Color", color(1, 1, 1)}});
    const int glow =
        c.add("ShaderNodeEmission", {{"Color", color(1, 1, 1)}, {"Strength", constant(4)}});
    const int mix = c.add("ShaderNodeMixShader", {{"Fac", constant(0.25f)},
                                                  {"Shader", link(clear, "BSDF")},
                                                  {"Shader_001", link(glow, "Emission")}});
    const CompiledSurface surface = c.compile(mix, "Shader");
    EXPECT_TRUE(surface.transparency.is(Vec3f(0.75f)));
    EXPECT_TRUE(surface.radiance.sources.emission.is(Vec3f(1.0f)));
    EXPECT_FALSE(surface.radiance.sources.additive);
}

TEST(NodeProgram, a_shared_shader_collects_all_its_weight) {
    Compiler c;
    const int glow =
        c.add("ShaderNodeEmission", {{"Color", color(1, 1, 1)}, {"Strength", constant(1)}});
    const int first = c.add("ShaderNodeAddShader", {{"Shader", link(glow, "Emission")},
                                                    {"Shader_001", link(glow, "Emission")}});
    const int second = c.add("ShaderNodeAddShader", {{"Shader", link(first, "Shader")},
                                                     {"Shader_001", link(glow, "Emission")}});
    EXPECT_TRUE(c.compile(second, "Shader").radiance.sources.emission.is(Vec3f(3.0f)));
}

TEST(NodeProgram, sockets_convert_colours_by_luminance_and_vectors_by_mean) {
    Compiler c;
    const int rgb = c.add("ShaderNodeRGB", {}, {{"color", std::vector<float>{0, 1, 0, 1}}});
    const int xyz =
        c.add("ShaderNodeCombineXYZ", {{"X", constant(0)}, {"Y", constant(1)}, {"Z", constant(0)}});
    const int math =
        c.add("ShaderNodeCombineXYZ",
              {{"X", link(rgb, "Color")}, {"Y", link(xyz, "Vector")}, {"Z", constant(0)}});
    const int emission =
        c.add("ShaderNodeEmission", {{"Color", link(math, "Vector")}, {"Strength", constant(1)}});
    const VectorSource out = c.compile(emission, "Emission").radiance.sources.emission;
    ASSERT_TRUE(out.is_constant());
    EXPECT_NEAR(out.constant.x, 0.7152f, 1e-4f);  // Rec. 709's green
    EXPECT_NEAR(out.constant.y, 1.0f / 3.0f, 1e-6f);
}

TEST(NodeProgram, bump_takes_its_slope_from_shifted_values) {
    // Height x over a plane with one unit of x a step: the normal leans to (-1, 0, 1).
    Compiler c;
    const int coordinate = c.add("ShaderNodeTexCoord", {});
    const int height = c.add("ShaderNodeSeparateXYZ", {{"Vector", link(coordinate, "Object")}});
    const int bump = c.add(
        "ShaderNodeBump",
        {{"Height", link(height, "X")}, {"Strength", constant(1)}, {"Distance", constant(1)}});
    const int emission =
        c.add("ShaderNodeEmission", {{"Color", link(bump, "Normal")}, {"Strength", constant(1)}});
    ShadingPoints points;
    points.count = 2;
    points.p = {Vec3f(0), Vec3f(0)};
    points.normal = points.view = points.geometric_normal = {Vec3f(0, 0, 1), Vec3f(0, 0, 1)};
    points.dp_du = {Vec3f(1, 0, 0), Vec3f(1, 0, 0)};
    points.dp_dv = {Vec3f(0, 1, 0), Vec3f(0, 1, 0)};
    points.backfacing = {0, 0};
    const CompiledSurface surface = c.compile(emission, "Emission");
    ASSERT_EQ(surface.requests.size(), 1u);
    EXPECT_TRUE(surface.requests[0].derivatives);
    const auto normals =
        run_emission(surface, attribute(Vec3f(0), Vec3f(5, 0, 0), Vec3f(1, 0, 0)), points);
    for (const Vec3f& n : normals) {
        EXPECT_NEAR(n.x, -std::sqrt(0.5f), 1e-6f);
        EXPECT_NEAR(n.z, std::sqrt(0.5f), 1e-6f);
    }
}

TEST(NodeProgram, unknown_node_is_reported_once_and_is_zero) {
    Compiler c;
    const int odd = c.add("ShaderNodeFromTheFuture", {});
    const int emission =
        c.add("ShaderNodeEmission", {{"Color", link(odd, "Color")}, {"Strength", constant(1)}});
    EXPECT_TRUE(c.compile(emission, "Emission").radiance.sources.emission.is(Vec3f(0.0f)));
    ASSERT_EQ(c.report.warnings().size(), 1u);
    EXPECT_EQ(c.report.warnings()[0].datablock, "material 'Test'");
    EXPECT_EQ(c.report.warnings()[0].count, 1u);
}

TEST(NodeProgram, without_air_a_sky_is_its_sun_alone) {
    Compiler c;
    constexpr double kDiameter = 0.2, kElevation = 0.5;
    const int sky = c.add("ShaderNodeTexSky", {},
                          {{"sky_type", std::string("MULTIPLE_SCATTERING")},
                           {"sun_elevation", kElevation},
                           {"sun_size", kDiameter},
                           {"air_density", 0.0},
                           {"aerosol_density", 0.0},
                           {"ozone_density", 0.0}});
    const int background =
        c.add("ShaderNodeBackground", {{"Color", link(sky, "Color")}, {"Strength", constant(2)}});
    c.graph.surface = {background, "Background"};
    const CompiledSurface world =
        compile_surface(c.graph, c.scene, c.textures, c.report, {"world 'Test'", true});
    ShadingPoints points;
    points.count = 2;
    points.p = {Vec3f(0, std::cos(kElevation), std::sin(kElevation)), Vec3f(0, 0, 1)};
    const auto radiance = run_emission(world, {}, points);
    // The sun's irradiance at four wavelengths, its luminance by the matrix of the fit, spread over
    // the disc.
    const double luminance =
        1.679 * 22.981338 + 1.828 * 71.347796 + 1.986 * 18.422961 + 1.307 * 2.3614214;
    const double solid_angle = 2 * M_PI * (1 - std::cos(0.5 * kDiameter));
    const Vec3f disc = radiance[0];
    EXPECT_NEAR(0.2126729 * disc.x + 0.7151522 * disc.y + 0.0721750 * disc.z,
                2 * luminance / solid_angle, 1e-3 * luminance / solid_angle);
    EXPECT_EQ(radiance[1], Vec3f(0.0f));
    EXPECT_TRUE(c.report.warnings().empty());
}

TEST(NodeProgram, forward_link_is_an_error_that_names_the_material) {
    Compiler c;
    const int emission = c.add("ShaderNodeEmission", {{"Color", link(7, "Color")}});
    try {
        c.compile(emission, "Emission");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_EQ(error.datablock(), "material 'Test'");
    }
}

TEST(NodeProgram, ten_thousand_nodes_in_a_row_need_no_stack) {
    Compiler c;
    int last = c.add("ShaderNodeValue", {}, {{"value", 0.0}});
    for (int i = 0; i < 10000; ++i)
        last =
            c.add("ShaderNodeMath", {{"Value", link(last, "Value")}, {"Value_001", constant(1)}});
    const int emission =
        c.add("ShaderNodeEmission", {{"Color", link(last, "Value")}, {"Strength", constant(1)}});
    EXPECT_TRUE(c.compile(emission, "Emission").radiance.sources.emission.is(Vec3f(10000.0f)));
}

TEST(NodeProgram, no_step_runs_after_a_cancel) {
    Progress progress;
    int ran = 0;
    const auto step = [&](int slot, bool cancels) {
        return Step{[&ran, &progress, cancels](granita::Run&) {
                        ++ran;
                        if (cancels) progress.cancel();
                    },
                    {},
                    {slot}};
    };
    const std::vector<Step> steps{step(0, false), step(1, true), step(2, false)};
    const Program program(std::vector<Load>{}, steps, {1, 1, 1}, {0, 1, 2});
    ShadingInput input;
    input.progress = &progress;
    granita::Run run = program.prepare(input, 1);
    EXPECT_THROW(program.execute(run), Cancelled);
    EXPECT_EQ(ran, 2);
}

}  // namespace
}  // namespace granita
