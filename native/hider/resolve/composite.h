// SPDX-License-Identifier: GPL-3.0-or-later
// From what the hider saw to one colour a sample: interpolate shading at the sample's own place,
// time and lens point, put the layers over each other.
#pragma once

#include <span>
#include <vector>

#include "hider/hider.h"
#include "hider/resolve/layer_table.h"
#include "hider/resolve/refined_samples.h"
#include "hider/resolve/sample_channels.h"
#include "hider/resolve/sample_volumes.h"
#include "hider/sample_store.h"
#include "hider/samples/sample_table.h"
#include "math/projection.h"

namespace granita {

struct CompositeSettings {
    Projection projection;
    ListEnd end;                           ///< the hider's: what was accumulated stays as it is
    bool film_transparent = false;         ///< no background; alpha is what covers it
    const ChannelSet* channels = nullptr;  ///< nullptr = no passes
    bool depth = true;                     ///< whether SampleColors::depth is wanted
    const Scene* catchers = nullptr;       ///< nullptr: it has none
    bool catchers_cut = false;             ///< as holdouts do, not showing the background
};

/// Fills [256 * samples] colours in sample order.  `background`: premultiplied radiance behind
/// everything: one value, or one a sample; read where the film is not transparent or channels have
/// the environment.  `table`: of the hider's pool.
///
/// Layers from front to back, each channel by itself: C += T c, O += a T, T -= a T, in double.
/// What is behind the layer with which a list ends adds nothing, neither surfaces nor background.
/// Interpolated opacity is clamped to [0, 1] here and nowhere earlier; radiance is not clamped.
/// Alpha is the mean of the three opacities without those of holdout surfaces; with a background it
/// is 1 less what holdouts cut out.  Depth is that of the first layer, or
/// anything where it is not wanted.  Fills `channels` where
/// settings.channels asks for some; holdouts take part in Merge::First and Center alone, but those
/// that catch shadows.  What else cuts has no depth, as in Cycles.
/// Layers of `refined` look as they do through `volumes`, their channels as without.
void composite_tile(const TileStore& store, const TileSamples& samples, LayerTable& table,
                    std::span<const Vec3f> background, const CompositeSettings& settings,
                    SampleColors& colors, SampleChannels* channels = nullptr,
                    const RefinedSamples& refined = {}, const SampleVolumes& volumes = {});

}  // namespace granita
