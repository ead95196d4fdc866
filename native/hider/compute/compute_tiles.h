// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gl/buffer.h"
#include "hider/bucket_tiles.h"
#include "hider/compute/compute_device.h"

namespace granita {

/// A run of a bucket's tiles in the device's memory: their samples and what these have seen.
/// Everything here is called on the thread that owns OpenGL.
class ComputeTiles {
  public:
    /// Tiles [first, first + count) of the bucket, whose samples fit in one buffer.
    ComputeTiles(ComputeDevice& device, BucketTiles& bucket, const HiderFrame& frame,
                 std::size_t first, std::size_t count);
    /// How many tiles of so many samples a pixel one object takes.  Throws GlError if not even one.
    static std::size_t capacity(int samples, const ComputeLimits& limits);

    /// Opaque hits stay on the device; transparent ones that they do not hide are appended to the
    /// bucket's stores.
    void hide(const ComputeBatch& batch);
    /// The farthest key of each block, [count][16].
    std::vector<float> farthest();
    /// Copies the nearest opaque surfaces of one of the tiles to the bucket's store, and back.
    void read_back(std::size_t tile);
    void write_back(std::size_t tile);

  private:
    void upload_samples(bool time);
    void upload_grids();
    void dispatch(const gl::Program& program, const std::vector<ComputeBlock>& blocks);
    void hide_transparent(const std::vector<ComputeBlock>& blocks, bool moving);
    void fill(const std::vector<ComputeBlock>& blocks, const std::vector<std::uint32_t>& counts,
              std::size_t begin, std::size_t end, std::uint32_t total, bool moving);
    void count_dispatch() const;

    ComputeDevice& m_device;
    BucketTiles& m_bucket;
    const HiderFrame& m_frame;
    std::size_t m_first, m_count;
    std::uint32_t m_samples_a_pixel, m_stride;  ///< samples of all the tiles
    bool m_has_time = false;
    gl::Buffer m_samples, m_seen, m_grids, m_entries, m_vertices;
};

}  // namespace granita
