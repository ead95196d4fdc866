// SPDX-License-Identifier: GPL-3.0-or-later
// The world as a light: its radiance baked over all directions, for importance sampling
// (pbrt 12.5). Directions are world axes; the map is equirectangular, z up, rows of equal polar
// angle.
#pragma once

#include <functional>
#include <vector>

#include "base/progress.h"
#include "math/vec.h"

namespace granita {

/// Radiance of the world along `directions` (unit, world axes), each standing for a cone of
/// `spread` radians (texture filtering).
using WorldEvaluator = std::function<void(const std::vector<Vec3f>& directions, float spread,
                                          std::vector<Vec3f>& out)>;

class Environment {
  public:
    /// Evaluates the world once at `height` x 2 `height` directions, in parallel.  Radiance that is
    /// not finite counts as black.  Throws Cancelled.
    Environment(const WorldEvaluator& world, const Progress& progress, int height = 512);

    /// Directions whose radiance was not finite.
    std::size_t broken() const { return m_broken; }
    bool is_black() const { return m_black; }
    /// Every baked direction has the same bits.
    bool is_constant() const { return m_constant; }
    /// Of a constant world.
    const Vec3f& constant_radiance() const { return m_constant_radiance; }

    /// Direction with a density near proportional to luminance; u in [0, 1)^2.
    Vec3f sample(const Vec2f& u, float& pdf) const;
    /// Density of sample(), per solid angle.
    float pdf(const Vec3f& direction) const;

    /// Angle between neighbouring directions of the table: what sample() stands for.
    float texel_angle() const;
    std::size_t bytes() const;

  private:
    /// [height][width]
    std::vector<Vec3f> bake(const WorldEvaluator& world, const Progress& progress) const;
    void build_distribution(const std::vector<Vec3f>& radiance);

    int m_width = 0, m_height = 0;
    std::size_t m_broken = 0;
    bool m_black = false, m_constant = false;
    Vec3f m_constant_radiance{0.0f};
    std::vector<float> m_rows;     ///< [height + 1] distribution over rows
    std::vector<float> m_columns;  ///< [height][width + 1] distribution inside each row
};

}  // namespace granita
