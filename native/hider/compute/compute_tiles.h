// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gl/buffer.h"
#include "gl/readback.h"
#include "hider/bucket_tiles.h"
#include "hider/compute/compute_device.h"

namespace granita {

/// A transparent hit, as hide.comp writes it.
struct DeviceFragment {
    float key;
    std::uint32_t sample;
    SurfaceId id;
};

/// Of two surfaces at one depth, as in shaders/compute/order.glsl.
struct ComputeGridOrder {
    std::uint32_t base, key[4];
};

/// A run of a bucket's tiles in the device's memory: their samples and what these have seen.
///
/// What the CPU prepares and takes over is done on the bucket's own thread, so that the one that
/// owns OpenGL only hands over and draws.
class ComputeTiles {
  public:
    /// Tiles [first, first + count) of the bucket, whose samples fit in one buffer.  Any thread.
    ComputeTiles(ComputeDevice& device, BucketTiles& bucket, const HiderFrame& frame,
                 std::size_t first, std::size_t count);
    /// How many tiles of so many samples a pixel one object takes.  Throws GlError if not even one.
    static std::size_t capacity(int samples, const ComputeLimits& limits);

    // On the bucket's thread:

    /// The batch as hide() will send it.
    void stage(const ComputeBatch& batch);
    /// Appends the transparent hits that hide() found to the bucket's stores.
    void collect();
    /// Copies what tiles [first, ...) have seen to the bucket's stores.
    void take(const gl::Readback& seen, std::size_t first);

    // On the thread that owns OpenGL; copies are waited for in a later job:

    /// Opaque hits stay on the device; transparent ones that they do not hide are for collect().
    void hide();
    /// The farthest key of each block, floats, [count][16].
    gl::Readback farthest() const;
    /// The nearest opaque surfaces of tiles, for take(); and back from the bucket's store.
    gl::Readback seen(std::size_t first, std::size_t count) const;
    void write_back(std::size_t tile) const;

  private:
    /// Of a part of the cells of the blocks: where their fragments are.
    struct Found {
        std::size_t begin, end;
        std::vector<DeviceFragment> fragments;
    };

    void stage_samples(bool time);
    void stage_grids();
    void upload();
    void dispatch(const gl::Program& program, const std::vector<ComputeBlock>& blocks) const;
    void hide_transparent();
    void fill(std::size_t begin, std::size_t end, std::uint32_t total);
    void count_dispatch() const;

    ComputeDevice& m_device;
    BucketTiles& m_bucket;
    const HiderFrame& m_frame;
    std::size_t m_first, m_count;
    std::uint32_t m_samples_a_pixel, m_stride;  ///< samples of all the tiles
    std::vector<ComputeBlock> m_all_blocks;     ///< for farthest()

    // Staged; empty: on the device already.
    std::vector<float> m_sample_values;
    std::vector<ComputeGridOrder> m_grid_order;
    ComputeBatch::Lists m_lists;
    std::vector<Vec4f> m_vertex_values;
    bool m_has_time = false, m_moving = false;

    std::vector<std::uint32_t> m_counts;  ///< transparent hits of the blocks' samples
    std::vector<Found> m_found;
    gl::Buffer m_samples, m_seen, m_grids, m_entries, m_vertices;
};

}  // namespace granita
