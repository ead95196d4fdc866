// SPDX-License-Identifier: GPL-3.0-or-later
// A primitive that several buckets want: split or diced once, by the first that needs it, and freed
// after the last (decision 5).  Primitives of a single bucket never come here; the bucket owns
// them.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/once.h"
#include "base/statistics.h"
#include "dice/primitive.h"
#include "hider/grid_sweep.h"
#include "render/bucket_layout.h"
#include "shade/shading_system.h"

namespace granita {

/// A diced grid and its slots, each filled once whoever asks first.
class SharedGrid {
  public:
    SharedGrid(std::unique_ptr<Grid> grid, Statistics& statistics);
    ~SharedGrid();
    const Grid& grid() const { return *m_grid; }
    void ensure_opacity(const ShadingSystem& shading, Statistics& statistics);
    /// `stays`: a later picture may shade it anew.
    void ensure_radiance(const ShadingSystem& shading, Statistics& statistics, bool stays = false);
    /// Between two pictures: the next one shades it anew.
    void forget_radiance();
    /// What hiding must know of it, once its opacity is there where that varies.
    const GridSweep& sweep(const Projection& projection, const LensShape& lens);

  private:
    void ensure_shading_state(Statistics& statistics);
    void count_bytes();

    std::unique_ptr<Grid> m_grid;
    Statistics& m_statistics;
    std::uint64_t m_bytes = 0;
    std::optional<GridSweep> m_sweep;
    Once m_has_state, m_opacity, m_has_sweep, m_radiance;
};

using HiddenGrids = std::vector<std::shared_ptr<SharedGrid>>;  ///< in a hider's arrival order

/// Splits until diceable and dices, with the counters.  nullptr when nothing is left of it.
std::shared_ptr<SharedGrid> dice_counted(const Primitive& primitive, Statistics& statistics);
std::vector<std::unique_ptr<Primitive>> split_counted(const Primitive& primitive,
                                                      Statistics& statistics);

class GeometryNode {
  public:
    GeometryNode(std::unique_ptr<Primitive> primitive, const RasterBounds& bounds,
                 const BucketLayout& layout, const GeometryNode* parent);

    struct Content {
        std::vector<std::shared_ptr<GeometryNode>> children;
        std::shared_ptr<SharedGrid> grid;
    };
    /// The children or the grid, made at the first call.  Thread-safe.
    Content expand(const BucketLayout& layout, Statistics& statistics);
    /// Bucket `b` will not ask again, here or below.  After the last one everything is freed.
    void release(int bucket);
    const RasterBounds& bounds() const { return m_bounds; }
    /// As Primitive::knot_boxes().
    const std::vector<Bounds3f>& knot_boxes() const { return m_knot_boxes; }

  private:
    std::size_t bit(int bucket) const;

    std::mutex m_mutex;
    RasterBounds m_bounds;
    Rect m_buckets;  ///< that want it, bucket coordinates
    int m_layout_width, m_layout_x0, m_layout_y0;
    std::vector<Bounds3f> m_knot_boxes;
    std::vector<bool> m_released;  ///< [m_buckets]
    std::size_t m_left = 0;        ///< not yet released
    std::unique_ptr<Primitive> m_primitive;
    bool m_expanded = false;
    Content m_content;
};

}  // namespace granita
