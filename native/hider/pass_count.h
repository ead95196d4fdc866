// SPDX-License-Identifier: GPL-3.0-or-later
// How many time and lens passes REGULAR sampling needs to keep its copies from showing (paper,
// 9.3.5; docs/sampling_error.md).
#pragma once

#include <functional>

namespace granita {

/// One axis of a pixel filter: its value at a distance from the centre, pixels; integral 1.
using FilterFactor = std::function<float(float)>;

/// An edge that moves `step` pixels from pass to pass is a staircase of copies.  Filtered, its ramp
/// has the slope S(x) = step sum_j f(x - j step) instead of 1: half of S from peak to peak.
double strobing_ripple(const FilterFactor& filter, double radius, double step);

/// The longest step, pixels, up to which no step ripples more than `ripple`.
double longest_step(const FilterFactor& filter, double radius, double ripple = 0.02);

/// The most that one frame moves and blurs.
struct FrameBlur {
    double motion = 0.0;  ///< path of a point on screen, pixels
    double lens = 0.0;    ///< radius of a circle of confusion, pixels
};

inline constexpr int kMostPasses = 128;

/// ceil(motion / step) passes spread copies no farther apart along any path than `step`, and
/// ceil(pi lens^2 / step^2) as densely over the lens: the larger of both, at least 1.
double passes_wanted(const FrameBlur& blur, double step);
/// The same, at most kMostPasses.
int pass_count(const FrameBlur& blur, double step);

}  // namespace granita
