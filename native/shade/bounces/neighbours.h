// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "math/bounds.h"
#include "math/vec.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// Steps of a grid to each side within which its points share.
constexpr std::size_t kNeighbourReach = 8;

/// What points of a grid found each by chance, each [points], a channel at a time.
struct NoisyValues {
    std::vector<Vec3f> values;
    std::vector<Vec3f> by_reach;  ///< 1 / metres within which values vary little
    std::vector<Vec3f> told;      ///< 1, or 0 where a point tells nothing of a channel
    std::vector<float> counts{};  ///< how many times they were looked for; empty: once
};

/// The same beside where the points lie, a column each: what grids around may be told.  Hidden
/// points hardly count (ShadingPoints::seen), others for as much as they asked (shares).
struct NoisyPoints {
    /// Behind the last there is room to read.
    using Column = std::vector<float>;
    using Columns = std::array<Column, 3>;  ///< of vectors, or channels

    std::size_t count = 0;
    Columns p, normal, values, by_reach, told;
    Column asked;
    Column side;  ///< 1: its back is seen, which finds other light
    /// Of points that are told something: what counts of the reach of either at most, as 1 /
    /// metres, and the metres within which neighbours lie at all.
    Column most_by_reach, reach;
    Bounds3f box;
    float longest_reach = 0.0f;
    bool is_grey = true;  ///< channels share alike

    NoisyPoints() = default;
    /// @param least_reach in steps of the grid, whatever NoisyValues::by_reach says.
    NoisyPoints(const ShadingPoints& points, const NoisyValues& noisy, float least_reach);
    /// [count] `values`.
    std::vector<Vec3f> all_values() const;
    /// Room for one more vector of points that are read at once.
    void pad();
    std::size_t bytes() const;
};

/// [points] what neighbours found together, of a grid and of those `around` it.  Slopes stay: each
/// point takes the plane that fits its neighbours best (locally weighted regression, Cleveland
/// 1979).  Of two the nearer reach decides.
std::vector<Vec3f> share(const ShadingPoints& points, const NoisyPoints& own,
                         std::span<const NoisyPoints* const> around = {});

}  // namespace granita
