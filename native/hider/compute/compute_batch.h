// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "hider/compute/compute_sweep.h"
#include "hider/simd/simd_kernel.h"
#include "math/vec.h"

namespace granita {

/// Bounds of what one step of the compute executor sends to the device.
struct ComputeLimits {
    /// Of each buffer: what OpenGL 4.5 guarantees a shader storage block (table 23.64).
    std::size_t buffer_bytes = std::size_t{128} << 20;
    /// Micropolygons times the blocks that they touch.  16,384 is about one layer of one-pixel
    /// micropolygons in a bucket of 64 pixels: what lies behind it can be culled.
    std::size_t entries = 16384;
};

/// A micropolygon in the list of a block; as in shaders/compute/hide.comp.
struct ComputeEntry {
    std::uint32_t vertex, right, up, knot, id, pixels, segment, segments, kind;
    float from, to;
};

/// A block of 4 x 4 pixels; as in shaders/compute/blocks.glsl.
struct ComputeBlock {
    std::uint32_t tile, block, first, count;
};

/// Micropolygons on their way to the device, in the lists of the blocks that they may touch.
///
/// Vertices are projected into each tile's raster space here, in double (TileGrid): binning needs
/// them anyway, every executor then tests the same floats, and the device needs no double for it.
class ComputeBatch {
  public:
    explicit ComputeBatch(const ComputeLimits& limits) : m_limits(limits) {}

    /// Adds what of the grid may touch the pixels of tile number `tile`.  Calls `run` whenever the
    /// batch is full, which must send it away and clear() it.
    void add(const SimdGrid& grid, std::uint32_t tile, const Rect& pixels,
             const std::function<void()>& run);
    bool empty() const { return m_entries.empty(); }
    bool moving() const { return m_moving; }
    void clear();

    /// What the device reads; the lists keep the order of arrival.
    struct Lists {
        std::vector<ComputeEntry> entries;
        std::vector<ComputeBlock> opaque, transparent;
    };
    Lists lists() const;
    const std::vector<Vec4f>& vertices() const { return m_vertices; }

  private:
    void add_to_blocks(ComputeEntry entry, std::uint32_t tile, const Rect& pixels,
                       const MicropolygonSweep& sweep, const Interval& life);
    std::uint32_t add_vertices(const SimdGrid& grid, int segment);

    ComputeLimits m_limits;
    std::vector<ComputeEntry> m_entries;
    std::vector<std::uint32_t> m_list;  ///< of each entry: (tile * 16 + block) * 2 + transparent
    std::vector<Vec4f> m_vertices;      ///< x w, y w, w, z
    std::uint32_t m_list_count = 0;
    bool m_moving = false;
};

}  // namespace granita
