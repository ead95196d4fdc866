// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

namespace granita {

/// The part of the shutter in which a thing exists: times t with open <= t < close.  Half open, so
/// that of two things of which one replaces the other every sample sees exactly one.
struct Lifespan {
    float open = 0.0f;
    /// Infinite where the thing outlives the shutter, whose end is a time of samples too.
    float close = std::numeric_limits<float>::infinity();

    bool is_whole() const { return open <= 0.0f && close > 1.0f; }
    /// Never within the shutter.
    bool is_empty() const { return !(open < close) || open > 1.0f || close <= 0.0f; }
    bool contains(float time) const { return time >= open && time < close; }
    /// Any time of [from, to].
    bool meets(float from, float to) const { return to >= open && from < close; }
    bool operator==(const Lifespan&) const = default;
};

}  // namespace granita
