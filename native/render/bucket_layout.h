// SPDX-License-Identifier: GPL-3.0-or-later
// The frame cut into buckets: squares of whole tiles, aligned to the frame's origin, over the
// pixels whose samples are needed.
#pragma once

#include <vector>

#include "math/bounds.h"

namespace granita {

class BucketLayout {
  public:
    /// `pixels`: what the buckets tile; `bucket_size`: pixels, a multiple of the tile size;
    /// `margin`: pixels around its own whose geometry a bucket wants too.  The CPU executors tile
    /// the crop with its filter margin and need no other margin (film merges); the raster executor
    /// tiles the crop and filters by itself.
    /// `around`: pixels beyond that in which a bucket looks for what lies beside its things.
    BucketLayout(const Rect& pixels, int bucket_size, int margin = 0, int around = 0);

    int count() const { return m_buckets.width() * m_buckets.height(); }
    /// The whole layout in bucket coordinates.
    const Rect& buckets() const { return m_buckets; }
    int index(int x, int y) const {
        return (y - m_buckets.y0) * m_buckets.width() + x - m_buckets.x0;
    }
    /// Bucket coordinates of an index.
    Vec2i place(int index) const {
        return {m_buckets.x0 + index % m_buckets.width(), m_buckets.y0 + index / m_buckets.width()};
    }
    /// Pixels of a bucket that are needed.
    Rect pixels(int index) const;
    /// pixels(index) with the margin.
    Rect reach(int index) const;
    /// Tiles that cover pixels(index), in tile coordinates.
    Rect tiles(int index) const;
    /// Buckets that a swept bound can touch, or be around of, in bucket coordinates; empty if none.
    Rect range(const RasterBounds& bounds) const;
    /// All indices, spiralling outwards from the centre.
    std::vector<int> spiral() const;

  private:
    Rect m_pixels;
    int m_size, m_margin, m_around;
    Rect m_buckets;
};

}  // namespace granita
