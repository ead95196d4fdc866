// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dice/grid.h"
#include "math/vec.h"
#include "shade/bounces/neighbours.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/lobe.h"
#include "shade/bsdf/reflection.h"

namespace granita {

/// What other surfaces send to points and these towards the view, each [points].
struct GatheredLight {
    std::vector<Vec3f> diffuse;      ///< that diffuse lobes reflect
    std::vector<Vec3f> glossy;       ///< that others do, but for
    std::vector<Vec3f> mirrored;     ///< what mirrors alone bring, which is in no doubt
    std::vector<Vec3f> transmitted;  ///< of these two, what goes through
    /// Of all that, what the first things that are met emit themselves; empty: nobody asks.
    std::vector<Vec3f> emitted;
    /// What rays that meet nothing bring of the world (WorldAhead), by what reflects it, and how
    /// far it is in doubt: of diffuse lobes, and of others.  Empty: they bring none.
    std::vector<BsdfValue> world;
    std::vector<Vec2f> world_balance;
    /// Sum of 1 / distance of what diffuse lobes' rays meet, and how many do: how fast its light
    /// changes from place to place.
    std::vector<float> nearness, met;
    std::vector<float> counts;  ///< how many times diffuse lobes gathered; empty: once

    explicit GatheredLight(std::size_t points)
        : diffuse(points, Vec3f(0.0f)),
          glossy(points, Vec3f(0.0f)),
          mirrored(points, Vec3f(0.0f)),
          transmitted(points, Vec3f(0.0f)),
          nearness(points, 0.0f),
          met(points, 0.0f) {}
};

/// What diffuse lobes of a grid's points gathered, by albedo, as they tell it each other and the
/// grids around: light of other surfaces and of the world between them, which varies as slowly as
/// these are far away (Ward, Rubinstein and Clear 1988, their error bound read the other way), and
/// of that the world's where somebody asks.
struct ToldGathered {
    NoisyPoints all;
    std::optional<NoisyPoints> world;
};

/// How many times more [points] are to gather: in corners too few share to agree on anything.  Such
/// points are seen as noise in a picture that is smooth elsewhere.
std::vector<std::uint8_t> times_more(const ShadingPoints& points, const GatheredLight& light);

/// Takes what diffuse lobes of `which` points gathered once `more` into the mean.
void add_gathered(GatheredLight& light, const GatheredLight& more,
                  std::span<const std::uint8_t> which);

/// @param takes_world the world's light, from `light`.diffuse; `tells_world`: and apart.
ToldGathered tell_gathered(const ShadingPoints& points, const SurfaceClosure& closure,
                           bool takes_world, bool tells_world, GatheredLight& light);

/// Adds what `light` has of the world to `radiance`, and where they are asked for, to `parts` and
/// the `noise` of points (DirectLight::reflect()).
void reflect_world(const GatheredLight& light, ReflectionParts* parts, std::vector<float>* noise,
                   std::vector<Vec3f>& radiance);

/// Adds what is reflected of `light`, and of what `grid` has gathered, to `radiance` [points] and,
/// where they are asked for, to its `parts`.
void reflect_gathered(const ShadingPoints& points, const GatheredLight& light, const Grid& grid,
                      const SurfaceClosure& closure, ReflectionParts* parts,
                      std::vector<Vec3f>& radiance);

}  // namespace granita
