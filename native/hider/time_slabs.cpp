// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/time_slabs.h"

#include <algorithm>

#include "dice/raster_bound.h"

namespace granita {
namespace {

constexpr int kLeastSlabs = 8;

/// Positions move linearly between knots, so the box between their boxes holds them.
Bounds3f mix(const Bounds3f& a, const Bounds3f& b, float part) {
    return {a.lo + part * (b.lo - a.lo), a.hi + part * (b.hi - a.hi)};
}

int slabs_a_segment(std::size_t knots) {
    const int segments = static_cast<int>(knots) - 1;
    return (kLeastSlabs + segments - 1) / segments;
}

}  // namespace

int slab_count(std::size_t knots) {
    return (static_cast<int>(knots) - 1) * slabs_a_segment(knots);
}

TimeSlab time_slab(std::span<const Bounds3f> boxes, int index, const Projection& projection) {
    const int parts = slabs_a_segment(boxes.size());
    const auto count = static_cast<float>(slab_count(boxes.size()));
    TimeSlab slab{static_cast<float>(index) / count, static_cast<float>(index + 1) / count, {}};
    const auto segment = static_cast<std::size_t>(index / parts);
    const Bounds3f &begin = boxes[segment], &end = boxes[segment + 1];
    if (begin.empty() || end.empty()) return slab;
    const auto at = [&](int part) {
        return mix(begin, end, static_cast<float>(part) / static_cast<float>(parts));
    };
    Bounds3f box = at(index % parts);
    box.add(at(index % parts + 1));
    box.grow_relative(4e-6f);  // more than single precision moves anything
    slab.bounds = raster_bound(projection, box);
    return slab;
}

}  // namespace granita
