// SPDX-License-Identifier: GPL-3.0-or-later
// Sorting fragments into the samples' lists, and where a list ends whatever else may come.
#pragma once

#include <vector>

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

/// Each sample's nearest opaque surface; `key` alone where nothing behind it counts.
struct OpaqueSurfaces {
    float* key;
    SurfaceId* id;
    std::size_t count;
};

/// Leaves out what is not in front of the sample's opaque surface and what is behind the end of its
/// list for certain: by bounds of opacity, not by opacity itself, so that nothing is left out that
/// would count, whatever arrives later: more layers can only bring the end nearer.  Where a list
/// ends, `surfaces` are told: the next float behind the last layer, kNoSurface.
/// Takes hidden fragments out of `arrived` and leaves the others there.
SampleLists make_lists(std::vector<SampleFragment>& arrived, const OpaqueSurfaces& surfaces,
                       const GridPool& pool, const ListEnd& end);

/// The same while more is to come: what is left out goes from `arrived`.
void cut_lists(std::vector<SampleFragment>& arrived, const OpaqueSurfaces& surfaces,
               const GridPool& pool, const ListEnd& end);

/// Lists are sorted anew each time that they are cut: growth by half, and by a fragment a sample,
/// bounds how often.
inline bool worth_cutting(std::size_t fragments, std::size_t left_then, std::size_t samples) {
    return fragments >= left_then + left_then / 2 + samples;
}

}  // namespace granita
