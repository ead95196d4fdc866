// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shade/bounces/bounced_path.h"

namespace granita {

/// A way by which a path goes on from a place.
struct ChosenWay {
    const LobeRay* ray;       ///< nullptr: straight on, through the surface
    Vec3f weight;             ///< of the light that comes along it
    float sure_part, chance;  ///< BouncedPath's
    bool is_sure;             ///< no chance chose it
    /// How likely it is to be worth following: what it meets counts as much more.
    float goes_on;
};

/// Of the ways out of a place where `path` has come to, those by which it goes on: what mirrors
/// bring is followed surely as far as it matters, of all others one, after their weights.
/// @param through what passes the surface straight on.
/// @param uniform in [0, 1).
/// @param out is filled.
void choose_ways(const BouncedPath& path, std::span<const LobeRay> ways, const Vec3f& through,
                 float uniform, std::vector<ChosenWay>& out);

/// Drops ways of gloss that bring little: each is kept as likely as it weighs less than the
/// heaviest of its point, and counts as much more.  `ways` of a point lie together.
void thin_out(std::vector<LobeRay>& ways, std::uint32_t seed);

}  // namespace granita
