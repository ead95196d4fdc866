// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lamp_shader.h"

#include "shade/nodes/node_compiler.h"
#include "shade/nodes/surface_run.h"

namespace granita {
namespace {

std::shared_ptr<const LightPattern> pattern_of(const Light& light, const Scene& scene,
                                               TextureStore& textures, Report& report) {
    const GraphOwner owner{"light '" + light.name + "'", true};
    const SurfaceProgram program =
        compile_surface(light.graph, scene, textures, report, owner, nullptr, RayType::Diffuse)
            .radiance;
    ShadingPoints points;
    points.p = LightPattern::directions();
    points.count = points.p.size();
    for (Vec3f& p : points.p) p = -p;  // to who looks at it
    ShadingInput input;
    input.points = &points;
    Run run = program.program.prepare(input, points.count);
    program.program.execute(run);
    return std::make_shared<const LightPattern>(values_of(run, program.sources.emission));
}

}  // namespace

LightPatterns light_patterns(const Scene& scene, TextureStore& textures, Report& report) {
    LightPatterns found(scene.lights.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Light& light = scene.lights[i];
        if (light.graph.surface.node < 0) continue;
        for (std::size_t j = 0; j < i && !found[i]; ++j)  // instances of one lamp share it
            if (found[j] && scene.lights[j].graph == light.graph) found[i] = found[j];
        if (!found[i]) found[i] = pattern_of(light, scene, textures, report);
    }
    return found;
}

}  // namespace granita
