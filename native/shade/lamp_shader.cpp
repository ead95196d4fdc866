// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lamp_shader.h"

#include <algorithm>
#include <map>

#include "base/object_pool.h"
#include "math/luminance.h"
#include "shade/nodes/node_compiler.h"
#include "shade/nodes/surface_run.h"
#include "shade/programs/shading_camera.h"

namespace granita {
namespace {

/// Who asks a lamp how bright it may be: so many around it, this far away in its own metres, each
/// in so many samples.  Of many that share their nodes each is asked by fewer.
constexpr std::uint32_t kMostAsking = 64, kFewestAsking = 8, kAllAsking = 8192, kAsked = 16;
constexpr float kFar = 10.0f;

/// Memory of a run, to be used again.
struct RunMemory {
    ShadingPoints points;
    std::vector<float> slots;
    std::vector<Vec3f> factors;
};

class NodePattern : public LightPattern {
  public:
    NodePattern(const Light& light, const Scene& scene, TextureStore& textures, Report& report)
        : m_light(light) {
        const Vec3d eye(ShadingCamera(scene).world_from_camera[3]);
        m_eye = Vec3f(eye);
        const GraphOwner owner{"light '" + light.name + "'", true, 0, &light};
        m_program =
            compile_surface(light.graph, scene, textures, report, owner, nullptr, RayType::Diffuse)
                .radiance;
    }

    void color(std::span<const PatternSample> samples) const override {
        auto memory = ObjectPool<RunMemory>::take();
        evaluate(samples, memory);
        for (std::size_t i = 0; i < samples.size(); ++i)
            samples[i].sample->radiance *= memory.factors[i];
        ObjectPool<RunMemory>::give(std::move(memory));
    }
    /// LampPattern::largest, of one that stands as `frame` does and is asked from so many places.
    float largest(const LightFrame& frame, std::uint32_t asking) const;

  private:
    /// What nodes make of samples: as Cycles sets up points of lamps.
    void evaluate(std::span<const PatternSample> samples, RunMemory& memory) const;

    const Light& m_light;
    Vec3f m_eye{0.0f};  ///< world
    SurfaceProgram m_program;
};

void NodePattern::evaluate(std::span<const PatternSample> samples, RunMemory& memory) const {
    const bool is_sphere = (m_light.kind == LightKind::Point || m_light.kind == LightKind::Spot) &&
                           m_light.radius > 0.0f && !m_light.soft_falloff;
    ShadingPoints& points = memory.points;
    points.count = samples.size();
    points.p.resize(points.count);
    points.normal.resize(points.count);
    points.view.resize(points.count);
    points.ray_lengths.resize(points.count);
    for (std::size_t i = 0; i < points.count; ++i) {
        const LightFrame& frame = *samples[i].frame;
        const LightSample& sample = *samples[i].sample;
        points.view[i] = -sample.direction;
        points.ray_lengths[i] = sample.distance;
        // A sun's place is where its light goes.
        points.p[i] = m_light.kind == LightKind::Sun
                          ? -sample.direction - m_eye
                          : samples[i].p + sample.distance * sample.direction;
        points.normal[i] = m_light.kind == LightKind::Area ? frame.direction
                           : is_sphere ? glm::normalize(points.p[i] - frame.position)
                                       : points.view[i];
    }
    ShadingInput input;
    input.points = &points;
    input.of_lamp = samples;
    Run run = m_program.program.prepare(input, points.count, std::move(memory.slots));
    m_program.program.execute(run);
    const auto factors = run.read(m_program.sources.emission);
    memory.factors.resize(points.count);
    for (std::size_t i = 0; i < points.count; ++i) memory.factors[i] = factors[i];
    make_finite(memory.factors);
    memory.slots = run.take_memory();
}

float NodePattern::largest(const LightFrame& frame, std::uint32_t asking) const {
    const auto source = make_light_source(m_light, frame);
    const SobolPoints around(1), over(2);
    std::vector<Vec2f> u;
    for (std::uint32_t i = 0; i < asking * kAsked; ++i) u.push_back(over(i));
    std::vector<LightSample> found(u.size());
    std::vector<PatternSample> samples;
    for (std::uint32_t i = 0; i < asking; ++i) {
        const Vec3f local = sample_cone(around(i), 2.0f);
        const Vec3f p = frame.position + Vec3f(frame.axes * Vec3d(kFar * local));
        const std::span<LightSample> own(found.data() + i * kAsked, kAsked);
        source->sample_all(p, {u.data() + i * kAsked, kAsked}, own);
        for (LightSample& sample : own)
            if (sample.pdf > 0.0f) samples.push_back({&frame, p, &sample});
    }
    RunMemory memory;
    evaluate(samples, memory);
    float largest = 0.0f;
    for (const Vec3f& factor : memory.factors) largest = std::max(largest, mean_size(factor));
    // Where none of these find light, others may.
    return largest > 0.0f ? largest : 1.0f;
}

/// Whether nodes say the same of both, but for where they stand.
bool are_alike(const Light& one, const Light& other) {
    if (!(one.graph == other.graph)) return false;  // a copy of each pair would be dear
    Light a = one, b = other;
    for (Light* light : {&a, &b}) {
        light->graph = {};
        light->name.clear();
        light->world_from_light.clear();
        light->energy_knots.clear();
        light->energy = 0.0f;
    }
    return a == b;
}

}  // namespace

std::vector<LampPattern> lamp_patterns(const Scene& scene, TextureStore& textures, Report& report) {
    const Vec3d eye(ShadingCamera(scene).world_from_camera[3]);
    std::vector<std::shared_ptr<const NodePattern>> found(scene.lights.size());
    std::map<const NodePattern*, std::uint32_t> sharing;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Light& light = scene.lights[i];
        if (light.graph.surface.node < 0) continue;
        for (std::size_t j = 0; j < i && !found[i]; ++j)  // instances of one lamp share it
            if (found[j] && are_alike(scene.lights[j], light)) found[i] = found[j];
        if (!found[i])
            found[i] = std::make_shared<const NodePattern>(light, scene, textures, report);
        ++sharing[found[i].get()];
    }
    std::vector<LampPattern> patterns(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (!found[i]) continue;
        const std::uint32_t asking =
            std::clamp(kAllAsking / sharing[found[i].get()], kFewestAsking, kMostAsking);
        const LightFrame frame = light_frame(scene.lights[i], scene.options.frame_time, eye);
        patterns[i] = {found[i], found[i]->largest(frame, asking)};
    }
    return patterns;
}

}  // namespace granita
