// SPDX-License-Identifier: GPL-3.0-or-later
// What samples of a grid's points share: where its sequences begin, and which part of them is a
// point's.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "dice/grid.h"
#include "math/sampling.h"
#include "shade/bsdf/lobe.h"

namespace granita {

/// Seed of a grid, from its identity alone (decision 3).
inline std::uint64_t grid_seed(const GridKey& key, std::uint32_t frame_seed) {
    const auto face = (static_cast<std::uint64_t>(key.instance) << 32) | key.face;
    return mix_bits(mix_bits(face + 0x9e3779b97f4a7c15ULL * (frame_seed + 1ULL)) ^ key.path);
}

/// Of the sequences of points: those that have places of their own share the frame's.
inline std::uint64_t sequence_seed(const ShadingPoints& points, const GridKey& key,
                                   std::uint32_t frame_seed) {
    return grid_seed(points.places.empty() ? key : GridKey{0, 0, 1 + points.depth}, frame_seed);
}

/// Neighbours share a sequence: aligned squares of points, and so the pixels that average them, are
/// stratified as one (Ahmed and Wonka 2020, without their shuffling of squares).  Faces of a batch
/// are in Morton order already.
inline std::uint32_t place_in_sequence(const ShadingPoints& points, std::size_t i) {
    if (!points.places.empty()) return points.places[i];
    if (points.columns == 0) return static_cast<std::uint32_t>(i);
    return morton_index(static_cast<std::uint32_t>(i % points.columns),
                        static_cast<std::uint32_t>(i / points.columns));
}

/// More than any point's place in a grid's sequences.
inline std::uint32_t beyond(const ShadingPoints& points) {
    if (points.columns == 0) return static_cast<std::uint32_t>(points.count);
    const auto columns = static_cast<std::uint32_t>(points.columns);
    const auto rows = static_cast<std::uint32_t>(points.count) / columns;
    const std::uint32_t side = std::bit_ceil(std::max(columns, rows));
    return side * side;
}

}  // namespace granita
