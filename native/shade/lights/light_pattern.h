// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "shade/lights/light_source.h"

namespace granita {

/// What a lamp's nodes make of its light.
class LightPattern {
  public:
    virtual ~LightPattern() = default;
    /// Multiplies the radiance of samples that have a pdf.  `world_from_light`: a turn alone.
    virtual void color(std::span<LightSample> samples, const Mat3f& world_from_light) const = 0;
    /// Mean of the channels, where that is largest; by distance, of a metre's.
    virtual float largest() const = 0;
};

/// By the direction in which light leaves alone: a table over the lamp's own directions, from
/// straight ahead (-z) to straight behind.
class DirectionTable : public LightPattern {
  public:
    /// Of its entries, unit.
    static std::vector<Vec3f> directions();
    /// `values`: in these.
    explicit DirectionTable(std::vector<Vec3f> values);

    void color(std::span<LightSample> samples, const Mat3f& world_from_light) const override;
    float largest() const override { return m_largest; }

  private:
    Vec3f at(const Vec3f& direction) const;

    std::vector<Vec3f> m_values;  ///< [rows][columns]
    float m_largest = 0.0f;
};

/// Of the nodes of a scene's lights: [lights], nullptr where there are none; empty: nowhere.
using LightPatterns = std::vector<std::shared_ptr<const LightPattern>>;

/// Sets what is no number to 0.
/// @return the largest mean of the channels.
float largest_finite(std::vector<Vec3f>& values);

/// A lamp whose light is that of `source` times a pattern.  `axes`: as LightFrame::axes.
std::unique_ptr<LightSource> with_pattern(std::unique_ptr<LightSource> source,
                                          std::shared_ptr<const LightPattern> pattern,
                                          const Mat3d& axes);

}  // namespace granita
