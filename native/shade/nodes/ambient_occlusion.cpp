// SPDX-License-Identifier: GPL-3.0-or-later
// Ambient Occlusion: the part of the cosine-weighted directions about a normal in which nothing is
// near.
#include <algorithm>
#include <cmath>

#include "math/normalize_or.h"
#include "shade/lights/grid_samples.h"
#include "shade/nodes/nodes.h"
#include "shade/rays/ray_scene.h"

namespace granita {
namespace {

struct OcclusionSettings {
    int samples;  ///< of what one sample of the picture sees
    bool inside, only_local;
    std::uint64_t seed;  ///< of the node
    int light_samples;   ///< what a point is worth
    std::uint32_t frame_seed;
    float frame_time;
};

/// The points of a run.
class OcclusionRays {
  public:
    OcclusionRays(const ShadingInput& in, const OcclusionSettings& settings)
        : m_in(in),
          m_points(*in.points),
          m_settings(settings),
          m_offset(in.rays->ray_offset(in.key)),
          m_alone(settings.only_local && in.rays->has_body(in.key)),
          m_sequence(sequence()),
          m_count(settings.samples *
                  std::max(1, static_cast<int>(std::lround(
                                  m_points.share * static_cast<float>(settings.light_samples))))) {}

    /// `about`: as long as it likes.
    float unoccluded(std::size_t i, const Vec3f& about, float distance) {
        if (!(distance > 0.0f) || (m_settings.only_local && !m_alone)) return 1.0f;
        const Vec3f normal = normalize_or(about, m_points.geometric_normal[i]);
        if (!m_points.faces.empty())
            m_offset = m_in.rays->ray_offset({m_in.key.instance, m_points.faces[i]});
        const bool timed = !m_points.times.empty() && m_points.times[i] >= 0.0f;
        const float time = timed ? m_points.times[i] : m_settings.frame_time;
        if (m_alone && (!m_body || m_body->time != time)) m_body = m_in.rays->body(m_in.key, time);
        const Basis basis(m_settings.inside ? -normal : normal);
        const SobolPoints sequence =
            m_sequence.from(place_in_sequence(m_points, i) * static_cast<std::uint32_t>(m_count));
        int passed = 0;
        for (int s = 0; s < m_count; ++s) {
            const Vec3f way =
                basis.to_world(sample_cosine_hemisphere(sequence(static_cast<std::uint32_t>(s))));
            const Ray ray{start(i, way), way, distance, time};
            passed += m_body ? !m_in.rays->nearest(*m_body, ray, m_met) : !m_in.rays->blocks(ray);
        }
        return static_cast<float>(passed) / static_cast<float>(m_count);
    }

  private:
    SobolPoints sequence() const {
        const std::uint64_t seed =
            mix_bits(sequence_seed(m_points, m_in.key, m_settings.frame_seed) ^ m_settings.seed);
        const SobolPoints points(seed);
        return m_points.places.empty() ? points : points.shuffled(seed);
    }
    /// On the side of the surface to which the way goes.
    Vec3f start(std::size_t i, const Vec3f& way) const {
        const Vec3f &p = m_points.p[i], &normal = m_points.geometric_normal[i];
        const Vec3f lifted =
            m_offset(m_points.ray_offset.empty() ? p : p + m_points.ray_offset[i], normal);
        return glm::dot(way, normal) < 0.0f ? 2.0f * p - lifted : lifted;
    }

    const ShadingInput& m_in;
    const ShadingPoints& m_points;
    const OcclusionSettings& m_settings;
    RayOffset m_offset;
    bool m_alone;  ///< there is something of its own to meet
    SobolPoints m_sequence;
    int m_count;
    std::optional<RayScene::Body> m_body;
    RayScene::Met m_met;
};

}  // namespace

void build_ambient_occlusion(NodeBuilder& b) {
    const VectorSource color = b.color("Color", Vec3f(1.0f));
    const Options& options = b.scene().options;
    const OcclusionSettings settings{std::max(1, static_cast<int>(b.value("samples", 16.0))),
                                     b.flag("inside"),
                                     b.flag("only_local"),
                                     b.index(),
                                     options.light_samples,
                                     options.seed,
                                     options.frame_time};
    FloatSource distance = b.number("Distance", 1.0f);
    if (distance.is(0.0f)) distance = {-1, static_cast<float>(b.value("world_distance", 10.0))};
    const VectorSource normal = b.normal_input();
    const FloatSource open = b.is_world() ? FloatSource{-1, 1.0f} : b.new_source<float>();
    if (!open.is_constant())
        b.add_step(
            [=](Run& run) {
                float* result = run.write(open);
                std::fill_n(result, run.count(), 1.0f);
                if (!run.input().rays) return;  // what displaces, and what shadows fall through
                OcclusionRays rays(run.input(), settings);
                const auto about = run.read(normal);
                const auto reach = run.read(distance);
                for (std::size_t i = 0; i < run.count(); ++i)
                    result[i] = rays.unoccluded(i, about[i], reach[i]);
            },
            {normal.slot, distance.slot}, {open.slot});
    b.output("AO", open);
    b.output_color("Color", scaled(b, color, open));
}

}  // namespace granita
