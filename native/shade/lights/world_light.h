// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "base/progress.h"
#include "base/report.h"
#include "scene/scene.h"
#include "shade/lights/environment.h"
#include "shade/lights/lamp_set.h"
#include "shade/lights/part_rays.h"

namespace granita {

/// The world of a frame as far as it sheds light on points.
class WorldLight {
  public:
    /// Bakes it, unless `world` sheds no light.  `evaluator` is kept.  Throws Cancelled.
    WorldLight(const World& world, WorldEvaluator evaluator, Report& report,
               const Progress& progress);

    bool shines() const { return m_environment != nullptr; }
    /// Whether sample() takes any.
    bool has_density() const { return shines() && m_environment->has_density(); }
    /// As WorldEvaluator::by_lobe.
    bool by_lobe() const { return m_evaluator.by_lobe; }

    /// A point's samples of the world's own density, where it has one.
    void sample(const LampSet& set, LitGrid& grid, const LitPoint& point) const;

    /// A sample of a lobe that is not sharp.
    struct LobeSample {
        Vec3f wo;
        BsdfValue value;  ///< of all lobes
        float sign;       ///< as LitGrid::sign
        RayType type;
        bool is_narrow;  ///< its lobe may be narrower than the world's texels
    };
    /// What the sample sees of a world that shines.
    void meet(const LampSet& set, LitGrid& grid, const LitPoint& point, const LitPlace& place,
              const LobeSample& sample) const;

    /// What comes of it along the sample's ray, of a `type`, if that meets nothing.
    WorldAhead ahead(const LampSet& set, const LitGrid& grid, const LitPoint& point,
                     const LobeSample& sample) const;
    WorldAhead ahead_of_mirror() const;
    /// What WorldAhead asks for: radiance along directions, as the parts of light see it.
    void radiance(const std::vector<Vec3f>& directions, const PartRays& types,
                  std::vector<BsdfValue>& out) const;

    /// Brings what waits for the world's radiance (LitGrid::look).
    void deliver(LitGrid& grid) const;

  private:
    bool is_asked(int depth) const { return depth <= m_most_bounces; }
    /// Of what comes along `wo`, where `pdf` is the world's density, that which lobes' samples
    /// bring.
    float share_of_lobes(const LampSet& set, const LitGrid& grid, const LitPoint& point,
                         const Vec3f& wo, float pdf) const;
    BsdfValue of_constant(const BsdfValue& weight, const PartRays& types) const;
    BsdfValue of_texel(const Environment::Sample& from, const BsdfValue& weight,
                       const PartRays& types) const;
    void look(LitGrid& grid, const EnvironmentSamples& samples, float spread,
              const PartRays& types) const;

    WorldEvaluator m_evaluator;
    int m_most_bounces;
    std::unique_ptr<Environment> m_environment;  ///< nullptr where the world sheds no light
};

}  // namespace granita
