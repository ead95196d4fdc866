// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lamp_shader.h"

#include "shade/nodes/light_path.h"
#include "shade/nodes/node_compiler.h"
#include "shade/nodes/surface_run.h"

namespace granita {
namespace {

/// Emission of a lamp's program where light leaves in `directions`, its own axes, and has come as
/// far as `distances`; empty: a metre.
std::vector<Vec3f> emission(const SurfaceProgram& program, std::vector<Vec3f> directions,
                            std::vector<float> distances) {
    ShadingPoints points;
    points.p = std::move(directions);
    points.count = points.p.size();
    for (Vec3f& p : points.p) p = -p;  // to who looks at it
    points.ray_lengths = std::move(distances);
    if (points.ray_lengths.empty()) points.ray_lengths.assign(points.count, 1.0f);
    ShadingInput input;
    input.points = &points;
    Run run = program.program.prepare(input, points.count);
    program.program.execute(run);
    return values_of(run, program.sources.emission);
}

/// Run for each sample.
class DistancePattern : public LightPattern {
  public:
    explicit DistancePattern(SurfaceProgram program) : m_program(std::move(program)) {
        std::vector<Vec3f> values = emission(m_program, DirectionTable::directions(), {});
        const float largest = largest_finite(values);
        if (largest > 0.0f) m_largest = largest;
    }

    void color(std::span<LightSample> samples, const Mat3f& world_from_light) const override {
        std::vector<Vec3f> directions;
        std::vector<float> distances;
        for (const LightSample& sample : samples) {
            directions.push_back(-sample.direction * world_from_light);
            distances.push_back(sample.distance);
        }
        std::vector<Vec3f> factors =
            emission(m_program, std::move(directions), std::move(distances));
        make_finite(factors);
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (samples[i].pdf > 0.0f) samples[i].radiance *= factors[i];
    }
    float largest() const override { return m_largest; }

  private:
    SurfaceProgram m_program;
    float m_largest = 1.0f;  ///< where a metre away nothing arrives, elsewhere something may
};

std::shared_ptr<const LightPattern> pattern_of(const Light& light, const Scene& scene,
                                               TextureStore& textures, Report& report) {
    const GraphOwner owner{"light '" + light.name + "'", true, 0, true};
    SurfaceProgram program =
        compile_surface(light.graph, scene, textures, report, owner, nullptr, RayType::Diffuse)
            .radiance;
    if (reads_ray_length(light.graph))
        return std::make_shared<const DistancePattern>(std::move(program));
    return std::make_shared<const DirectionTable>(
        emission(program, DirectionTable::directions(), {}));
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
