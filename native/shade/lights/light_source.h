// SPDX-License-Identifier: GPL-3.0-or-later
// A light of the scene as shading points see it: what arrives from where.  Shading space (world
// axes, origin at the camera of the frame time), Blender's units as Cycles converts them:
//
//   point, spot   radiant intensity P / (4 pi); soft ones a disc of that radius that faces the
//   point
//                 (or a sphere of radiance P / (4 pi^2 r^2)), so that the irradiance at distance d
//                 is P / (4 pi d^2)
//   sun           irradiance P across the direction, spread over its angle
//   area          radiance P / (pi A) on the front side, whatever the shape
#pragma once

#include <memory>
#include <span>

#include "math/bounds.h"
#include "math/sampling.h"
#include "math/vec.h"
#include "scene/light.h"

namespace granita {

/// Light that arrives at a point from one direction.
struct LightSample {
    Vec3f direction{0.0f};  ///< unit, from the point to the light
    float distance = 0.0f;  ///< metres; infinite for suns
    Vec3f radiance{0.0f};   ///< of hard lights: the irradiance across the direction
    float pdf = 0.0f;       ///< per solid angle; 1 of hard lights; 0 = nothing arrives
};

/// Where a light's power goes, as a bound.  At `p` it makes no more irradiance than `intensity` /
/// (d^2 + near2), d to its sphere's box, times the cosine of the angle by which the way there
/// leaves the cone, and none from `fall` past the cone on.
struct LightEmission {
    Vec3f axis{0.0f, 0.0f, -1.0f};
    float cone = kPi, fall = 0.5f * kPi;  ///< radians
    float intensity = 0.0f;               ///< mean of the channels; with nodes an estimate
    float near2 = 0.0f;                   ///< square metres
};

class LightSource {
  public:
    virtual ~LightSource() = default;
    /// Without a size: one direction a point, never met by a ray.
    virtual bool is_hard() const = 0;
    /// What arrives at `p`, a sample for each of `u`.
    virtual void sample_all(const Vec3f& p, std::span<const Vec2f> u,
                            std::span<LightSample> samples) const = 0;
    /// One of them; false when nothing arrives.
    bool sample(const Vec3f& p, const Vec2f& u, LightSample& sample) const {
        sample_all(p, {&u, 1}, {&sample, 1});
        return sample.pdf > 0.0f;
    }
    /// What arrives at `p` from `direction`; its pdf is that of sample().  False when the ray
    /// misses the light or it sends nothing.
    virtual bool intersect(const Vec3f& p, const Vec3f& direction, LightSample& sample) const = 0;
    /// Of a surface: whether it passes between a point and where the rays of that start.
    virtual bool separates(const Vec3f& /*p*/, const Vec3f& /*start*/) const { return false; }
    /// A sphere around the light, shading space; false for lights without a place.
    virtual bool bound(Vec3f& center, float& radius) const = 0;
    /// Of lights that have a place: what rays have to pass to meet it.
    virtual Bounds3f box() const {
        Bounds3f box;
        Vec3f center(0.0f);
        float radius = 0.0f;
        bound(center, radius);
        box.add(center);
        box.grow(radius);
        return box;
    }
    /// Of lights that have a place.
    virtual LightEmission emission() const = 0;
};

/// How a light stands at a time of the shutter.
struct LightFrame {
    Vec3f position;     ///< shading space
    Mat3d axes;         ///< world_from_light without translation, scale included
    Vec3f direction;    ///< unit, where the light shines: -z of the light
    Vec3f power{0.0f};  ///< colour times energy
};
/// `origin`: the camera's world position.
LightFrame light_frame(const Light& light, float time, const Vec3d& origin);

std::unique_ptr<LightSource> make_light_source(const Light& light, const LightFrame& frame);

// The kinds, one file each.
std::unique_ptr<LightSource> make_point_light(const Light& light, const LightFrame& frame);
std::unique_ptr<LightSource> make_sun_light(const Light& light, const LightFrame& frame);
std::unique_ptr<LightSource> make_area_light(const Light& light, const LightFrame& frame);

}  // namespace granita
