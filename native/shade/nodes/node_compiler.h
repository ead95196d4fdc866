// SPDX-License-Identifier: GPL-3.0-or-later
// From a node graph to programs: opacity (only what feeds transparency) and radiance
// (docs/architecture.md, decision 6).
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "scene/channels.h"
#include "shade/programs/program.h"
#include "shade/programs/surface_builder.h"
#include "shade/rays/ray_type.h"

namespace granita {

/// Values for passes alone, beside what the surface sends out.
struct PassSources {
    VectorSource uv;                       ///< the constant 0 where it is not asked for
    VectorSource now, previous, next;      ///< places in object space, of Speed; likewise
    std::vector<bool> writes_aov;          ///< [Options::aovs] whether some node does
    std::vector<VectorSource> aov_colors;  ///< [Options::aovs]; 0 where no node writes it
    std::vector<FloatSource> aov_values;   ///< likewise
};

struct SurfaceProgram {
    Program program;
    SurfaceSources sources;
    PassSources passes;
    bool is_bumped = false;
    VectorSource bumped;         ///< where `is_bumped`: the shading normal, bent by displacement
    bool bends_normals = false;  ///< nodes may give lobes others
    bool is_patterned = false;   ///< places that are near each other may tell nothing of others
                                 ///< between them

    /// Whether diffuse lobes of all points look where the surface does.
    bool looks_ahead() const {
        return !is_bumped && !bends_normals &&
               std::ranges::none_of(sources.lobes, [](const LobeSource& lobe) {
                   return lobe.kind == LobeKind::Translucent;
               });
    }
    bool scatters() const { return !sources.subsurface.empty(); }
    /// Whether some lobe sends light on in more than one direction.
    bool spreads() const {
        return scatters() || std::ranges::any_of(sources.lobes, [](const LobeSource& lobe) {
                   return !is_of_facets(lobe.kind) ||
                          (lobe.distribution != Distribution::Sharp &&
                           !(lobe.roughness.is_constant() && lobe.roughness.constant == 0.0f));
               });
    }
    /// Whether nodes bend normals of what is scattered below the surface.
    bool bends_scattered() const {
        return scatters() &&
               (is_bumped || std::ranges::any_of(sources.subsurface, &SubsurfaceSource::is_bent));
    }
};

/// What transparency needs alone.
struct OpacityProgram {
    std::vector<AttributeRequest> requests;
    Program program;
    VectorSource transparency;
    bool is_painted = false;  ///< by attributes alone: of a place nothing else is read
};

struct CompiledSurface {
    std::vector<AttributeRequest> requests;  ///< of opacity and radiance, which grids are shaded by
    Program opacity_program;
    VectorSource transparency;  ///< of opacity_program
    SurfaceProgram radiance;
    OpacityProgram passing;      ///< opacity_program for single places that rays meet
    OpacityProgram shadow;       ///< the same as shadow rays meet them
    bool is_told_apart = false;  ///< by shadow rays and such as bring light

    /// Whether edges of faces show: corners of micropolygons lie on them, or between two of them.
    bool has_lines() const {
        return std::ranges::any_of(
            requests, [](const AttributeRequest& request) { return is_to_corner(request.source); });
    }
};

/// Where the points of a surface go.
struct DisplacementProgram {
    std::vector<AttributeRequest> requests;
    Program program;
    VectorSource offset;  ///< world axes
    /// Whether instances of one geometry may be displaced differently.
    bool depends_on_instance = false;
    /// No offset is longer, in the space that the node names; infinite where the graph does not
    /// tell.
    float longest = 0.0f;
    bool longest_in_world = false;
};

/// What is inside of what a graph is of.
struct VolumeProgram {
    std::vector<AttributeRequest> requests;
    Program program;
    VolumeSources sources;
    VectorSource emission;  ///< radiance a metre

    /// The same everywhere.
    bool is_homogeneous() const { return program.loads().empty() && program.step_count() == 0; }
};

/// Whose graph it is.
struct GraphOwner {
    std::string name;  ///< for messages: "material 'Wood'"
    bool is_world = false;
    int material_index = 0;       ///< pass_index
    const Light* lamp = nullptr;  ///< that it colours; then `is_world` is set, too
};

/// Whether what the graph's surface says may depend on what is near.
bool asks_rays(const NodeGraph& graph);
/// Whether on other parts of what it is on, whatever these are to light.
bool asks_itself(const NodeGraph& graph);

/// The first of `rays`, of which `ray` is one, that the Light Path of what feeds `root` does not
/// tell apart from it.
RayType first_alike(const NodeGraph& graph, const NodeLink& root, RayType ray,
                    std::span<const RayType> rays);
/// Of the surface.
inline RayType first_alike(const NodeGraph& graph, RayType ray, std::span<const RayType> rays) {
    return first_alike(graph, graph.surface, ray, rays);
}

/// Compiles `graph.volume`, which is there.
VolumeProgram compile_volume(const NodeGraph& graph, const Scene& scene, TextureStore& textures,
                             Report& report, const GraphOwner& owner, RayType ray);

/// Compiles `graph.displacement`, which is there.
DisplacementProgram compile_displacement(const NodeGraph& graph, const Scene& scene,
                                         TextureStore& textures, Report& report,
                                         const GraphOwner& owner);

/// Compiles `graph.surface` for rays of a type, and what `passes` need beside it.  The scene,
/// textures and report must outlive the programs.
CompiledSurface compile_surface(const NodeGraph& graph, const Scene& scene, TextureStore& textures,
                                Report& report, const GraphOwner& owner,
                                const ChannelSet* passes = nullptr, RayType ray = RayType::Camera);

}  // namespace granita
