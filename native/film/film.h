// SPDX-License-Identifier: GPL-3.0-or-later
// From composited samples to pixels: filter, merge the margins of tiles in a fixed order, normalise
// by the weight. The sum of a pixel is grouped by source tile and added in raster order of tiles,
// so no bit depends on bucket size, order, threads or crop.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "film/filter_pieces.h"
#include "film/tile_sums.h"
#include "hider/resolve/sample_channels.h"
#include "hider/sample_store.h"
#include "hider/samples/sample_table.h"
#include "math/bounds.h"

namespace granita {

/// A pass beside Combined and Depth.
struct TilePass {
    std::string name;
    int width = 1;
    std::vector<float> values;  ///< [height][pixels][width], lower-left first
};

/// A finished rectangle of the picture.
struct Tile {
    Rect rect;                     ///< pixels of the frame
    std::vector<Vec4f> combined;   ///< [height][width] premultiplied linear RGBA, lower-left first
    std::vector<float> depth;      ///< [height][width] or empty
    std::vector<TilePass> passes;  ///< in the order of ChannelSet::passes()
};

/// What one sample tile contributes to the pixels around it.
struct TileContribution {
    Vec2i tile{0, 0};
    Rect rect;                  ///< pixels it reaches; those outside of the crop hold anything
    TileSums sums;              ///< [rect]
    Rect own;                   ///< pixels inside the tile, cut to the crop
    std::vector<float> depth;   ///< [own] or empty without the pass
    std::vector<float> center;  ///< [own][ChannelSet::center_width()]
};

/// A sample weighs w = f(dx) f(dy) / (samples of its pixel): pixels with more samples do not pull
/// their neighbours (hard case 7).  A pixel is sum(w c) / sum(w): the ratio makes what is constant
/// come out constant under any filter and any sample pattern, at the price of a bias that vanishes
/// with the number of samples.
///
/// Passes (scene/channels.h) weigh like Combined where Cycles filters them: colours premultiplied
/// by opacity and what is before them, Normal, UV and AOVs of the first surface with 0 where there
/// is none.  Diffuse and Glossy Direct are the ratio of filtered light and filtered colour, Shadow
/// that of lamps with and without shadows; Mist is 1 less the filtered clarity.  Depth, Position
/// and the indices are of one sample.
class Film {
  public:
    explicit Film(const Options& options);
    ~Film();
    /// Pixels whose samples are needed: the crop grown by the filter's radius (may reach outside
    /// the frame).
    Rect sample_pixels() const { return m_sample_pixels; }
    const ChannelSet& channels() const { return m_channels; }
    /// `colors` [256 * samples], in sample index order of the tile; `channels` where there are
    /// passes.  Thread-safe.
    TileContribution filter_tile(Vec2i tile, const TileSamples& samples, const SampleColors& colors,
                                 const SampleChannels* channels = nullptr) const;
    /// Thread-safe.  Every tile that overlaps sample_pixels() arrives exactly once, in any order.
    /// Returns the pixels (of `bucket_size` squares cut to the crop) that became complete.
    ///
    /// Depth is not filtered: a pixel takes the sample nearest to its centre, as Cycles takes one
    /// sample; kNoDepth where that sees nothing.
    std::vector<Tile> add(std::vector<TileContribution> contributions);

    static constexpr float kNoDepth = 1e10f;  ///< Cycles' value

  private:
    struct Pending;
    struct CellSums;
    void finish_passes(const CellSums& sums, Tile& out) const;
    Tile finish_cell(const Rect& cell,
                     std::vector<std::shared_ptr<const TileContribution>> parts) const;

    Options m_options;
    ChannelSet m_channels;
    PixelFilter m_filter;
    FilterPieces m_pieces;
    int m_each_side;  ///< pixels that a sample reaches beyond its own
    Rect m_sample_pixels;
    std::mutex m_mutex;
    std::unique_ptr<Pending> m_pending;
};

}  // namespace granita
