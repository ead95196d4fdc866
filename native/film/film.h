// SPDX-License-Identifier: GPL-3.0-or-later
// From composited samples to pixels: filter, merge the aprons of tiles in a fixed order, normalise
// by the weight. The sum of a pixel is grouped by source tile and added in raster order of tiles,
// so no bit depends on bucket size, order, threads or crop.
#pragma once

#include <map>
#include <mutex>
#include <vector>

#include "film/filter.h"
#include "hider/sample_table.h"
#include "math/bounds.h"

namespace granita {

/// A composited sample, premultiplied.
struct SampleColor {
    Vec3f color{0.0f};
    float alpha = 0.0f;
    float depth = 0.0f;  ///< camera z of the nearest surface, metres; infinity = none
};

/// A finished rectangle of the picture.
struct Tile {
    Rect rect;                    ///< pixels of the frame
    std::vector<Vec4f> combined;  ///< [height][width] premultiplied linear RGBA, lower-left first
    std::vector<float> depth;     ///< [height][width] or empty
};

/// What one sample tile contributes to the pixels around it.
struct TileContribution {
    Vec2i tile{0, 0};
    Rect rect;                  ///< pixels it reaches, cut to the crop
    std::vector<Vec4f> sum;     ///< sum of w * (rgb, a)
    std::vector<float> weight;  ///< sum of w
    std::vector<float> depth;   ///< of the pixels inside the tile; empty without the pass
};

class Film {
  public:
    explicit Film(const Options& options);
    /// Pixels whose samples are needed: the crop grown by the filter's radius (may reach outside
    /// the frame).
    Rect sample_pixels() const;
    /// `colors` [256 * samples], in sample index order of the tile.
    TileContribution filter_tile(Vec2i tile, const TileSamples& samples,
                                 const std::vector<SampleColor>& colors) const;
    /// Thread-safe.  Returns the pixels (of `bucket_size` squares cut to the crop) that became
    /// complete.
    std::vector<Tile> add(std::vector<TileContribution> contributions);

  private:
    struct Pending;
    Options m_options;
    PixelFilter m_filter;
    std::mutex m_mutex;
};

}  // namespace granita
