// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle of a mesh that shines alike to all sides, as Cycles samples it: radiance, whatever its
// size.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "shade/lights/light_source.h"
#include "shade/rays/ray.h"

namespace granita {

class TriangleLight : public LightSource {
  public:
    using Corners = std::array<Vec3f, 3>;

    /// `corners`: shading space.
    TriangleLight(const Corners& corners, const Vec3f& radiance);

    bool is_hard() const override { return false; }
    void sample_all(const Vec3f& p, std::span<const Vec2f> u,
                    std::span<LightSample> samples) const override;
    bool intersect(const Vec3f& p, const Vec3f& direction, LightSample& sample) const override;
    bool separates(const Vec3f& p, const Vec3f& start) const override {
        return height(p) * height(start) <= 0.0f;
    }
    bool bound(Vec3f& center, float& radius) const override;
    Bounds3f box() const override;
    LightEmission emission() const override;
    float area() const { return m_area; }  ///< square metres
    const Corners& corners() const { return m_corners; }
    /// Distance at which a ray from `p` meets it, in lengths of the direction; 0: it does not.
    static float crossing(const Corners& corners, const Vec3f& p, const Vec3f& direction);

  private:
    /// Whether it is so far that its area is as good to sample as its solid angle.
    bool is_far(const Vec3f& p) const;
    /// How far `p` may be off where it was meant to be, or a corner.
    float rounding(const Vec3f& p) const;
    /// Of the plane over `p`, along the normal; 0 where `p` is meant to lie on it.
    float height(const Vec3f& p) const;

    Corners m_corners;
    Vec3f m_normal, m_radiance;
    float m_area, m_longest2;  ///< square metres; of the longest edge
};

/// The same while it moves.
struct MovingTriangle {
    std::vector<TriangleLight::Corners> corners;            ///< [knots], object space
    std::shared_ptr<const std::vector<Mat4d>> from_object;  ///< [knots], to shading space
    Vec3f radiance;
    RayTarget target;  ///< what rays meet of it

    bool is_still() const { return corners.size() == 1 && from_object->size() == 1; }
    /// Shading space.
    TriangleLight::Corners placed(float time) const;
    TriangleLight at(float time) const { return {placed(time), radiance}; }
    /// Where each knot of the transform has each of the corners: what lies between is in their
    /// hull.
    void at_knots(const std::function<void(const TriangleLight&)>& visit) const;
};

}  // namespace granita
