// SPDX-License-Identifier: GPL-3.0-or-later
// The frame cut into buckets: squares of whole tiles, aligned to the frame's origin, over the
// pixels whose samples are needed.
#pragma once

#include <vector>

#include "math/bounds.h"

namespace granita {

class BucketLayout {
  public:
    /// `sample_pixels`: pixels whose samples are needed (crop and filter apron); `bucket_size`:
    /// pixels, a multiple of the tile size.
    BucketLayout(const Rect& sample_pixels, int bucket_size);

    int count() const { return m_buckets.width() * m_buckets.height(); }
    /// The whole layout in bucket coordinates.
    const Rect& buckets() const { return m_buckets; }
    int index(int x, int y) const {
        return (y - m_buckets.y0) * m_buckets.width() + x - m_buckets.x0;
    }
    /// Pixels of a bucket that are needed.
    Rect pixels(int index) const;
    /// Tiles that cover pixels(index), in tile coordinates.
    Rect tiles(int index) const;
    /// Buckets that a swept bound can touch, in bucket coordinates; empty if none.
    Rect range(const RasterBounds& bounds) const;
    /// All indices, spiralling outwards from the centre.
    std::vector<int> spiral() const;

  private:
    Rect m_pixels;
    int m_size;
    Rect m_buckets;
};

}  // namespace granita
