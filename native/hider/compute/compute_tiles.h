// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gl/buffer.h"
#include "gl/readback.h"
#include "hider/bucket_tiles.h"
#include "hider/compute/compute_device.h"

namespace granita {

/// A run of a bucket's tiles in the device's memory: their samples and what these have seen.
///
/// What the CPU prepares and takes over is done on the bucket's own thread, so that the one that
/// owns OpenGL only hands over and draws.
class ComputeTiles {
  public:
    /// Transparent hits that fit a buffer: of which samples, and where each begins.
    struct Part {
        std::size_t begin, end;  ///< samples of the blocks, [block][16 pixels][samples]
        std::vector<std::uint32_t> places;
        std::uint32_t fragments;
    };

    /// Tiles [first, first + count) of the bucket, whose samples fit in one buffer.
    ComputeTiles(ComputeDevice& device, BucketTiles& bucket, const HiderFrame& frame,
                 std::size_t first, std::size_t count);
    /// How many tiles of so many samples a pixel one object takes.  Throws GlError if not even one.
    static std::size_t capacity(int samples, const ComputeLimits& limits);

    // On the bucket's thread:

    /// The batch as hide() will send it; it must not change before.
    void stage(const ComputeBatch& batch);
    /// What fill() is to be called with, of the counts.
    std::vector<Part> parts(const gl::Readback& counts);
    /// Appends a part's fragments to the bucket's stores.
    void collect(const Part& part, const gl::Readback& fragments);
    /// Copies what tiles [first, ...) have seen to the bucket's stores.
    void take(const gl::Readback& seen, std::size_t first);

    // On the thread that owns OpenGL; copies are to be waited for in a later job:

    /// Opaque hits stay on the device; transparent ones that they do not hide are counted.
    void hide();
    /// Of the transparent hits, a sample; where the batch has any.
    std::optional<gl::Readback> counts() const;
    /// The transparent hits of a part.
    gl::Readback fill(const Part& part) const;
    /// The farthest key of each block, floats, [count][16].
    gl::Readback farthest() const;
    /// The nearest opaque surfaces of tiles, for take(); and back from the bucket's store.
    gl::Readback seen(std::size_t first, std::size_t count) const;
    void write_back(std::size_t tile) const;

  private:
    /// Of two surfaces at one depth the one whose grid comes first, as in
    /// shaders/compute/order.glsl.
    struct GridOrder {
        std::uint32_t base, key[4];
    };

    void stage_samples(bool time);
    void stage_grids();
    void upload();
    void dispatch(int pass, const std::vector<ComputeBlock>& blocks) const;
    void count_dispatch() const;

    ComputeDevice& m_device;
    BucketTiles& m_bucket;
    const HiderFrame& m_frame;
    std::size_t m_first, m_count;
    std::uint32_t m_samples_a_pixel, m_stride;  ///< samples of all the tiles
    std::vector<ComputeBlock> m_all_blocks;     ///< for farthest()

    // Staged.
    std::vector<float> m_sample_values;  ///< empty: those on the device do
    bool m_has_time = false;
    std::vector<GridOrder> m_grid_order;
    ComputeBatch::Lists m_lists;
    const ComputeBatch* m_batch = nullptr;

    std::vector<std::uint32_t> m_counts;  ///< that parts() was given
    gl::Buffer m_samples, m_seen, m_grids, m_entries, m_vertices, m_count_buffer;
};

}  // namespace granita
