// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dice/grid.h"
#include "scene/options.h"

namespace granita {

/// What find_unsettled() takes, of the settings of a frame.
struct UnsettledThresholds {
    float difference, noise;

    /// @param moves anything of the frame.
    UnsettledThresholds(const Options& options, bool moves);
};

/// The most that two colours differ by in any channel, displayed (math/displayed.h).
float displayed_difference(const Vec3f& a, const Vec3f& b);

/// The most that two opacities differ by in any channel.
float opacity_difference(const Vec3f& a, const Vec3f& b);

bool are_equal(const std::vector<Vec3f>& values);

/// Fills Grid::unsettled: the micropolygons that interpolating their corners would draw wrong:
/// where displayed colour along a row of corners bends by more than `threshold`, be it an edge or a
/// highlight, and, as an edge ends anywhere, those that share a point with one.  Slopes are drawn
/// right.
/// @param noise [points] how far each corner's luminance is in doubt: what may be that alone is no
/// edge, but is refined itself where it is larger than `noise_threshold`.
/// @param settled [vertices] or empty: the radiance without what happens to be too bright at single
/// points, which would be refined where it is not too dark.
void find_unsettled(Grid& grid, std::vector<Vec3f>& settled, std::span<const float> noise,
                    float threshold, float noise_threshold);

/// Those of both, of which either may be empty.
void mark(std::vector<std::uint8_t>& marks, const std::vector<std::uint8_t>& more);

/// Marks the same by the grid's opacity, in any channel as it is: edges of cut-outs.
std::vector<std::uint8_t> unsettled_opacity(const Grid& grid, float threshold);

/// Marks them all.
std::vector<std::uint8_t> all_micropolygons(const Grid& grid);

/// Gives the grid no radiance: every sample that meets it is to be shaded by itself.
/// @param channels floats that a vertex has besides.
void leave_to_samples(Grid& grid, int channels);

}  // namespace granita
