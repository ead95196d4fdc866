// SPDX-License-Identifier: GPL-3.0-or-later
// Values are built from the first node to the last, once a shift; closures from the last to the
// first, so that a node shared by several mixes has all its weight when its turn comes.  No
// recursion: graphs come thousands of nodes deep.  What no result needs is dropped at the end by
// Program, so a slice is nothing but another set of roots.
#include "shade/nodes/node_compiler.h"

#include <algorithm>

#include "base/error.h"
#include "shade/nodes/displacement_range.h"
#include "shade/nodes/light_path.h"
#include "shade/nodes/node_registry.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

constexpr const char* kAovOutput = "ShaderNodeOutputAOV";
constexpr const char* kLightPath = "ShaderNodeLightPath";

/// Of Bump's Filter Width: its default since Blender 4.3, and the least that there is.
constexpr float kBumpWidth = 0.1f, kLeastBumpWidth = 0.001f;

/// The AOV Output node of that name: of several the last wins, as in Cycles; -1 = none.
int find_aov_output(const NodeGraph& graph, const std::string& name) {
    for (std::size_t i = graph.nodes.size(); i-- > 0;) {
        const Node& node = graph.nodes[i];
        if (node.type != kAovOutput) continue;
        const auto found = node.properties.find("aov_name");
        if (found == node.properties.end()) continue;
        const auto* text = std::get_if<std::string>(&found->second);
        if (text && *text == name) return static_cast<int>(i);
    }
    return -1;
}

/// [nodes] the outputs that something reads, of the root the one that is shown; AOV Outputs, which
/// have none, read themselves.
using ReadOutputs = std::vector<std::set<std::string>>;

ReadOutputs read_outputs(const NodeGraph& graph, const NodeLink& root, const std::string& owner,
                         const std::vector<int>& aov_outputs) {
    ReadOutputs read(graph.nodes.size());
    const auto check = [&](const NodeLink& link, std::size_t limit) {
        if (link.node < 0 || static_cast<std::size_t>(link.node) >= limit)
            throw SceneError(owner, "a node link does not point to an earlier node");
        read[link.node].insert(link.output);
    };
    if (root.node >= 0) check(root, graph.nodes.size());
    for (const int node : aov_outputs)
        if (node >= 0) read[node].insert("");
    for (std::size_t i = graph.nodes.size(); i-- > 0;) {
        if (read[i].empty()) continue;
        for (const auto& [name, input] : graph.nodes[i].inputs) {
            if (const auto* link = std::get_if<NodeLink>(&input)) check(*link, i);
        }
    }
    return read;
}

/// Whether anything of the surface or of a pass reads an Ambient Occlusion, `local`: one of the
/// thing alone.
bool occlusion_is_read(const NodeGraph& graph, bool local) {
    const auto is_asked = [local](const Node& node) {
        return node.type == "ShaderNodeAmbientOcclusion" && (!local || node.flag("only_local"));
    };
    if (std::ranges::none_of(graph.nodes, is_asked)) return false;
    std::vector<int> passes;
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        if (graph.nodes[i].type == kAovOutput) passes.push_back(static_cast<int>(i));
    const ReadOutputs read = read_outputs(graph, graph.surface, "", passes);
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        if (!read[i].empty() && is_asked(graph.nodes[i])) return true;
    return false;
}

/// Magenta is what Cycles shows where something is missing; unknown values are neutral instead, so
/// that one exotic node does not spoil a material.
void warn_about_kin(NodeBuilder& b, const NodeKind* kind) {
    const std::string& type = b.node().type;
    if (!kind) {
        b.warn(type + " is not supported; its outputs are zero");
    } else if (kind->kin) {
        b.warn(type + " is not supported; rendered as " + kind->kin);
    }
}

void push_root(std::vector<int>& roots, int slot) {
    if (slot >= 0) roots.push_back(slot);
}

std::vector<int> roots_of(const SurfaceSources& sources, const PassSources& passes) {
    std::vector<int> roots;
    for (const int slot : {passes.uv.slot, passes.now.slot, passes.previous.slot, passes.next.slot})
        push_root(roots, slot);
    for (const VectorSource& color : passes.aov_colors) push_root(roots, color.slot);
    for (const FloatSource& value : passes.aov_values) push_root(roots, value.slot);
    push_root(roots, sources.emission.slot);
    push_root(roots, sources.transparency.slot);
    for (const LobeSource& lobe : sources.lobes) {
        for (const int slot :
             {lobe.weight.slot, lobe.normal.slot, lobe.roughness.slot, lobe.f0.slot, lobe.f90.slot,
              lobe.ior.slot, lobe.tangent.slot, lobe.aspect.slot})
            push_root(roots, slot);
        for (const FloatSource& value : lobe.more) push_root(roots, value.slot);
    }
    for (const SubsurfaceSource& lobe : sources.subsurface)
        for (const int slot :
             {lobe.weight.slot, lobe.normal.slot, lobe.albedo.slot, lobe.radius.slot,
              lobe.anisotropy.slot, lobe.alpha.slot, lobe.ior.slot})
            push_root(roots, slot);
    return roots;
}

PassSources pass_sources(ProgramBuilder& builder, const NodeGraph& graph,
                         const std::vector<int>& aov_outputs, const ChannelSet& passes) {
    PassSources sources;
    const Node none;
    if (passes.find(Quantity::Uv)) {
        NodeBuilder b(builder, none, 0, Shift::None);
        sources.uv = b.attribute({AttributeSource::DefaultUv, "", 2});
    }
    if (passes.find(Quantity::Speed)) {
        NodeBuilder b(builder, none, 0, Shift::None);
        sources.now = b.attribute({AttributeSource::ObjectPosition, "", 3});
        sources.previous = b.attribute({AttributeSource::PreviousPosition, "", 3});
        sources.next = b.attribute({AttributeSource::NextPosition, "", 3});
    }
    for (const int index : aov_outputs) {
        const Node& node = index < 0 ? none : graph.nodes[index];
        NodeBuilder b(builder, node, static_cast<std::size_t>(std::max(index, 0)), Shift::None);
        sources.writes_aov.push_back(index >= 0);
        sources.aov_colors.push_back(b.color("Color"));
        sources.aov_values.push_back(b.number("Value"));
    }
    return sources;
}

/// Keeps the requests that some live load reads; a shifted load asks for derivatives.
std::vector<AttributeRequest> used_requests(std::vector<AttributeRequest> all,
                                            const std::vector<Program*>& programs) {
    std::vector<bool> used(all.size());
    for (const Program* program : programs) {
        for (const Load& load : program->loads()) {
            used[load.request] = true;
            if (load.shift != Shift::None) all[load.request].derivatives = true;
        }
    }
    std::vector<AttributeRequest> kept;
    std::vector<int> number(all.size(), -1);
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!used[i]) continue;
        number[i] = static_cast<int>(kept.size());
        kept.push_back(all[i]);
    }
    for (Program* program : programs) program->renumber_requests(number);
    return kept;
}

/// How far the heights of a graph's bumps are told apart, pixels: one until Blender 4.3, which lets
/// artists choose.  Of several the least, as the nodes below them are built once; 0: nothing is
/// bumped.
float bump_width(const NodeGraph& graph, const ReadOutputs& read) {
    float least = 0.0f;
    const auto add = [&least](float width) {
        least = least > 0.0f ? std::min(least, width) : width;
    };
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const Node& node = graph.nodes[i];
        if (node.type != "ShaderNodeBump" || read[i].empty()) continue;
        const auto found = node.inputs.find("Filter Width");
        const auto* width =
            found == node.inputs.end() ? nullptr : std::get_if<Vec4f>(&found->second);
        add(width ? std::max(width->x, kLeastBumpWidth) : 1.0f);
    }
    if (graph.bends_normals()) {
        const Node& root = graph.nodes[static_cast<std::size_t>(graph.displacement.node)];
        add(root.value("version") >= 403.0 ? kBumpWidth : 1.0f);
    }
    return least;
}

bool varies(const NodeOutputs::value_type& output) {
    const NodeOutput& of = output.second;
    return of.kind == SocketKind::Number ? !of.number.is_constant() : !of.vector.is_constant();
}

/// Values of all nodes that are read.
void build_values(ProgramBuilder& builder, const NodeGraph& graph) {
    builder.outputs.assign(graph.nodes.size(), {});
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        if (builder.read[i].empty() || graph.nodes[i].type == kAovOutput) continue;
        const NodeKind* kind = find_node_kind(graph.nodes[i].type);
        // The shifted values first: the value at the point may need their differences.
        for (const Shift shift : {Shift::U, Shift::V, Shift::None}) {
            NodeBuilder b(builder, graph.nodes[i], i, shift);
            if (shift == Shift::None) warn_about_kin(b, kind);
            if (kind && kind->build) kind->build(b);
        }
        builder.is_patterned |= kind && makes_pattern(*kind, graph.nodes[i]) &&
                                std::ranges::any_of(builder.outputs[i][0], varies);
    }
}

/// What the displacement output holds at a shift; 0 where that is nothing.
VectorSource displacement_at(ProgramBuilder& builder, const NodeGraph& graph, Shift shift) {
    const auto root = static_cast<std::size_t>(graph.displacement.node);
    const NodeOutputs& outputs = builder.outputs[root][static_cast<std::size_t>(shift)];
    const auto found = outputs.find(graph.displacement.output);
    if (found == outputs.end()) return {-1, Vec3f(0.0f)};
    if (found->second.kind != SocketKind::Number) return found->second.vector;
    NodeBuilder b(builder, graph.nodes[root], root, shift);
    return b.map<Vec3f>([](float x) { return Vec3f(x); }, found->second.number);
}

/// As Cycles does: the displacement's own nodes are built a second time, with normals not bent.
void bend_normals(ProgramBuilder& builder, const NodeGraph& graph) {
    ReadOutputs of_surface = std::move(builder.read);
    builder.read = read_outputs(graph, graph.displacement, builder.owner, {});
    build_values(builder, graph);
    const auto root = static_cast<std::size_t>(graph.displacement.node);
    NodeBuilder b(builder, graph.nodes[root], root, Shift::None);
    const VectorSource here = displacement_at(builder, graph, Shift::None),
                       next_u = displacement_at(builder, graph, Shift::U),
                       next_v = displacement_at(builder, graph, Shift::V);
    builder.bumped = bumped_by_displacement(b, here, next_u, next_v);
    builder.is_bumped = true;
    builder.read = std::move(of_surface);
}

/// Values and closures of all nodes that are read.
SurfaceBuilder build_closures(ProgramBuilder& builder, const NodeGraph& graph,
                              SurfaceBuilder::Socket socket) {
    const NodeLink& link = socket == SurfaceBuilder::Socket::Surface ? graph.surface : graph.volume;
    build_values(builder, graph);
    SurfaceBuilder surface(graph.nodes.size(), socket);
    if (link.node >= 0) {
        const auto root = static_cast<std::size_t>(link.node);
        NodeBuilder b(builder, graph.nodes[root], root, Shift::None);
        surface.add_weight(b, link, {-1, 1.0f});
    }
    for (std::size_t i = graph.nodes.size(); i-- > 0;) {
        if (surface.weight(i).is(0.0f)) continue;
        NodeBuilder b(builder, graph.nodes[i], i, Shift::None);
        const NodeKind* kind = find_node_kind(graph.nodes[i].type);
        if (kind && kind->build_closure) {
            kind->build_closure(b, surface, surface.weight(i));
        } else if (kind && kind->build) {
            // A colour in a shader socket emits, as in Blender.
            const NodeOutputs& outputs = builder.outputs[i][0];
            const auto found = outputs.find(surface.output(i));
            if (found == outputs.end()) continue;
            const NodeOutput& from = found->second;
            const VectorSource color =
                from.kind == SocketKind::Number
                    ? b.map<Vec3f>([](float x) { return Vec3f(x); }, from.number)
                    : from.vector;
            surface.add_emission(b, scaled(b, color, surface.weight(i)));
        }
    }
    return surface;
}

SurfaceSources build_graph(ProgramBuilder& builder, const NodeGraph& graph) {
    if (graph.bends_normals()) bend_normals(builder, graph);
    SurfaceSources sources =
        build_closures(builder, graph, SurfaceBuilder::Socket::Surface).sources();
    if (graph.has_only_volume()) sources.transparency = {-1, Vec3f(1.0f)};
    return sources;
}

Program opacity_program(const ProgramBuilder& builder, const VectorSource& transparency) {
    std::vector<int> roots;
    push_root(roots, transparency.slot);
    return Program(builder.loads, builder.steps, builder.widths, roots);
}

OpacityProgram passing_program(const ProgramBuilder& builder, const VectorSource& transparency) {
    OpacityProgram passing{{}, opacity_program(builder, transparency), transparency};
    passing.is_painted = passing.program.is_still();
    passing.requests = used_requests(builder.requests, {&passing.program});
    return passing;
}

bool told_apart(const NodeGraph& graph, const ReadOutputs& read, RayType a, RayType b) {
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
        if (graph.nodes[i].type == kLightPath && told_apart(read[i], a, b)) return true;
    return false;
}

}  // namespace

bool asks_rays(const NodeGraph& graph) {
    return occlusion_is_read(graph, false);
}

bool asks_itself(const NodeGraph& graph) {
    return occlusion_is_read(graph, true);
}

RayType first_alike(const NodeGraph& graph, const NodeLink& root, RayType ray,
                    std::span<const RayType> rays) {
    const ReadOutputs read = read_outputs(graph, root, "", {});
    return *std::ranges::find_if(
        rays, [&](RayType other) { return !told_apart(graph, read, other, ray); });
}

DisplacementProgram compile_displacement(const NodeGraph& graph, const Scene& scene,
                                         TextureStore& textures, Report& report,
                                         const GraphOwner& owner) {
    ProgramBuilder builder{.scene = scene,
                           .textures = textures,
                           .report = report,
                           .owner = owner.name,
                           .material_index = owner.material_index,
                           .read = read_outputs(graph, graph.displacement, owner.name, {})};
    build_values(builder, graph);
    DisplacementProgram compiled;
    compiled.depends_on_instance = depends_on_instance(graph, builder.read);
    compiled.offset = displacement_at(builder, graph, Shift::None);
    compiled.longest = longest_displacement(graph, scene.images);
    compiled.longest_in_world = is_in_world(graph);
    std::vector<int> roots;
    push_root(roots, compiled.offset.slot);
    compiled.program = Program(builder.loads, builder.steps, builder.widths, roots);
    compiled.requests = used_requests(builder.requests, {&compiled.program});
    return compiled;
}

VolumeProgram compile_volume(const NodeGraph& graph, const Scene& scene, TextureStore& textures,
                             Report& report, const GraphOwner& owner, RayType ray) {
    ProgramBuilder builder{.scene = scene,
                           .textures = textures,
                           .report = report,
                           .owner = owner.name,
                           .is_world = owner.is_world,
                           .material_index = owner.material_index,
                           .ray_type = ray,
                           .is_volume = true,
                           .read = read_outputs(graph, graph.volume, owner.name, {})};
    const SurfaceBuilder built = build_closures(builder, graph, SurfaceBuilder::Socket::Volume);
    VolumeProgram compiled;
    compiled.sources = built.volume();
    compiled.emission = built.sources().emission;
    std::vector<int> roots;
    push_root(roots, compiled.emission.slot);
    push_root(roots, compiled.sources.absorption.slot);
    for (const PhaseSource& phase : compiled.sources.phases) {
        push_root(roots, phase.scattering.slot);
        push_root(roots, phase.first.slot);
        push_root(roots, phase.second.slot);
    }
    compiled.program = Program(builder.loads, builder.steps, builder.widths, roots);
    compiled.requests = used_requests(builder.requests, {&compiled.program});
    return compiled;
}

CompiledSurface compile_surface(const NodeGraph& graph, const Scene& scene, TextureStore& textures,
                                Report& report, const GraphOwner& owner, const ChannelSet* passes,
                                RayType ray) {
    std::vector<int> aov_outputs;
    if (passes)
        for (const Aov& aov : scene.options.aovs)
            aov_outputs.push_back(find_aov_output(graph, aov.name));
    // Cycles makes vertices' normals anew where displacement alone tells of the relief.
    const bool has_moved_normals =
        graph.moves_surface() && graph.displacement_method == DisplacementMethod::Displacement;
    const auto builder_for = [&](RayType type, Report& warnings) {
        ReadOutputs read = read_outputs(graph, graph.surface, owner.name, aov_outputs);
        const float width = bump_width(graph, read);
        return ProgramBuilder{.scene = scene,
                              .textures = textures,
                              .report = warnings,
                              .owner = owner.name,
                              .is_world = owner.is_world,
                              .lamp = owner.lamp,
                              .material_index = owner.material_index,
                              .moves_surface = graph.moves_surface(),
                              .has_moved_normals = has_moved_normals,
                              .ray_type = type,
                              .bump_width = width,
                              .read = std::move(read)};
    };
    ProgramBuilder builder = builder_for(ray, report);

    CompiledSurface compiled;
    compiled.radiance.sources = build_graph(builder, graph);
    if (passes) compiled.radiance.passes = pass_sources(builder, graph, aov_outputs, *passes);
    compiled.radiance.is_bumped = builder.is_bumped;
    compiled.radiance.bumped = builder.bumped;
    compiled.radiance.bends_normals = builder.bends_normals;
    // What rays tell differs by chance.
    compiled.radiance.is_patterned = builder.is_patterned && !asks_rays(graph);
    std::vector<int> roots = roots_of(compiled.radiance.sources, compiled.radiance.passes);
    if (builder.is_bumped) push_root(roots, builder.bumped.slot);
    compiled.radiance.program = Program(builder.loads, builder.steps, builder.widths, roots);
    compiled.transparency = compiled.radiance.sources.transparency;
    compiled.opacity_program = opacity_program(builder, compiled.transparency);
    compiled.passing = passing_program(builder, compiled.transparency);
    compiled.is_told_apart = std::ranges::any_of(kLightRays, [&](RayType light) {
        return told_apart(graph, builder.read, light, RayType::Shadow);
    });
    if (told_apart(graph, builder.read, ray, RayType::Shadow)) {
        Report said_already;
        ProgramBuilder shadow = builder_for(RayType::Shadow, said_already);
        const VectorSource transparency = build_graph(shadow, graph).transparency;
        compiled.shadow = passing_program(shadow, transparency);
    } else {
        compiled.shadow = compiled.passing;
    }
    compiled.requests =
        used_requests(builder.requests, {&compiled.radiance.program, &compiled.opacity_program});
    return compiled;
}

}  // namespace granita
