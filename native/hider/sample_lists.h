// SPDX-License-Identifier: GPL-3.0-or-later
// Sorting the samples' lists, and where a list ends whatever else may come.
#pragma once

#include "hider/sample_store.h"

namespace granita {

/// How far a sample's list is followed.
struct ListEnd {
    /// Colour ends after the fragment that brings the smallest channel of accumulated opacity here;
    /// 1 = never.
    float opacity_threshold = 1.0f;
    /// Depth and channels of the first surface are those of the first layer of so much mean
    /// opacity, which may lie behind that.
    float pass_alpha_threshold = 0.0f;
};

/// [slots] each sample's nearest opaque surface; `key` alone where nothing behind it counts.
struct OpaqueSurfaces {
    float* key;
    SurfaceId* id;
};

/// Where slots are samples.
inline OpaqueSurfaces surfaces_of(TileStore& store) {
    return {store.key.data(), store.id.data()};
}

/// Sorts each list, nearest first, ties by GridPool::before.  Leaves out what is not in front of
/// the sample's opaque surface and what is behind the end of its list for certain: by bounds of
/// opacity, not by opacity itself, so that nothing is left out that would count, whatever arrives
/// later: more layers can only bring the end nearer.  Where a list ends, `surfaces` are told: the
/// next float behind the last layer, kNoSurface.  `seen`, by id: set to 1 for what is left; may be
/// absent.
void sort_lists(FragmentLists& lists, const OpaqueSurfaces& surfaces, const GridPool& pool,
                const ListEnd& end, char* seen = nullptr);

/// Where more is to come, lists are sorted anew each time that they are cut: growth by half, and by
/// a fragment a sample, bounds how often.
inline bool worth_cutting(std::uint64_t fragments, std::uint64_t left_then, std::size_t samples) {
    return fragments >= left_then + left_then / 2 + samples;
}

}  // namespace granita
