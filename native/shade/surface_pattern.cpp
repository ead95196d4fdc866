// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/surface_pattern.h"

#include <algorithm>
#include <numeric>

#include "shade/bounces/hit_points.h"
#include "shade/nodes/surface_run.h"

namespace granita {
namespace {

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
    std::vector<std::uint32_t> order(ends.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto instance = [&](std::uint32_t i) { return ends[i].hit.instance; };
    std::ranges::stable_sort(order, {}, instance);
    HitPoints points(m_scene, m_rays);
    std::vector<MetPath> batch;
    for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
        batch.clear();
        for (end = begin; end < order.size() && instance(order[end]) == instance(order[begin]);
             ++end) {
            const RayScene::Met& met = ends[order[end]];
            const PatternSample& sample = samples[met.ray];
            batch.push_back(
                {nullptr, &met.hit, &met.frame(), sample.time, sample.width, met.hit.distance});
        }
        points.fill(batch, m_program.requests, 1);
        Run run = m_program.program.prepare(points.input(), batch.size());
        m_program.program.execute(run);
        std::vector<Vec3f> sent = values_of(run, m_program.emission);
        make_finite(sent);
        for (std::size_t i = 0; i < batch.size(); ++i)
            samples[order[begin + i]].sample->radiance = sent[i];
    }
}

}  // namespace

std::shared_ptr<const LightPattern> surface_pattern(const EmissionProgram& program,
                                                    const Scene& scene, const RayScene& rays) {
    return std::make_shared<const SurfacePattern>(program, scene, rays);
}

}  // namespace granita
