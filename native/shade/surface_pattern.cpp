// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/surface_pattern.h"

#include "base/sorted_runs.h"
#include "math/hash.h"
#include "shade/bounces/hit_points.h"
#include "shade/nodes/surface_run.h"

namespace granita {
namespace {

/// In sequences of samples: any, of its own.  Where all had one, nodes that look around (Ambient
/// Occlusion) looked along the same few directions everywhere, which no number of samples averages.
std::uint32_t place_of(const Vec3f& p) {
    return hash_bits(p.x, p.y, p.z);
}

class SurfacePattern : public LightPattern {
  public:
    SurfacePattern(const EmissionProgram& program, const Scene& scene, const RayScene& rays)
        : m_program(program), m_scene(scene), m_rays(rays) {}

    void color(std::span<const PatternSample> samples) const override;

  private:
    const EmissionProgram& m_program;
    const Scene& m_scene;
    const RayScene& m_rays;
};

void SurfacePattern::color(std::span<const PatternSample> samples) const {
    std::vector<Ray> rays;
    for (const PatternSample& one : samples)
        rays.push_back({.start = one.p,
                        .direction = one.sample->direction,
                        .distance = one.sample->distance,
                        .time = one.time,
                        .target = one.target});
    std::vector<RayScene::Met> ends;
    m_rays.ends(rays, ends);
    const auto instance = [&](std::uint32_t i) { return ends[i].hit.instance; };
    std::vector<std::uint32_t> order;
    HitPoints points(m_scene, m_rays);
    std::vector<MetPath> batch;
    for_sorted_runs(order, ends.size(), instance, [&](std::span<const std::uint32_t> of) {
        batch.clear();
        for (const std::uint32_t i : of) {
            const RayScene::Met& met = ends[i];
            const PatternSample& sample = samples[met.ray];
            batch.push_back({nullptr, &met.hit, &met.frame(), sample.time, sample.width,
                             met.hit.distance, 0.0f, place_of(met.hit.p)});
        }
        points.fill(batch, m_program.requests, 1);
        Run run = m_program.program.prepare(points.input(), batch.size());
        m_program.program.execute(run);
        std::vector<Vec3f> sent = values_of(run, m_program.emission);
        make_finite(sent);
        for (std::size_t i = 0; i < batch.size(); ++i) samples[of[i]].sample->radiance = sent[i];
    });
}

}  // namespace

std::shared_ptr<const LightPattern> surface_pattern(const EmissionProgram& program,
                                                    const Scene& scene, const RayScene& rays) {
    return std::make_shared<const SurfacePattern>(program, scene, rays);
}

}  // namespace granita
