// SPDX-License-Identifier: GPL-3.0-or-later
// What of a scene is another than in the scene before, in the groups that stages of the renderer
// read; and which stage reads which.  What no group names is of `Rest`, which all stages read.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace granita {

namespace part {
using Set = std::uint32_t;
inline constexpr Set kFilm = 1;          ///< pixel filter, transparency of the film
inline constexpr Set kLens = 2;          ///< radius and focus of a lens that is still, blades
inline constexpr Set kLightSamples = 4;  ///< of lamps, and ways of bounced light
inline constexpr Set kLights = 8;        ///< lamps and the world
inline constexpr Set kRays = 16;         ///< who is lit by what, and seen by other than the camera
inline constexpr Set kMaterials = 32;    ///< SceneChanges::materials, images
inline constexpr Set kPasses = 64;       ///< those that are asked for, and their settings
inline constexpr Set kRest = 128;

/// What samples see, unless materials change opacity, displacement or attributes, or passes look
/// farther through what is transparent.
inline constexpr Set kReadByHiding = kLens | kRest;
/// Opacity that asks rays, besides: how many, and what casts shadows and lets light through.
inline constexpr Set kReadByOpacityRays = kLightSamples | kRays | kMaterials;
/// The radiance of a grid whose points are the same, and its channels.
inline constexpr Set kReadByShading =
    kLightSamples | kLights | kRays | kMaterials | kPasses | kRest;
}  // namespace part

/// Whether channels of the same names hold the same.
bool same_channels(const Options& a, const Options& b);

struct SceneChanges {
    /// Geometries are told apart by address: `now` has adopted those of `before`
    /// (render/session.h).
    SceneChanges(const Scene& before, const Scene& now);

    part::Set parts = 0;
    std::vector<bool> materials;  ///< [materials] of the scene now, which are others
};

}  // namespace granita
