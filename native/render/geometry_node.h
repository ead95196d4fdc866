// SPDX-License-Identifier: GPL-3.0-or-later
// A primitive that is wanted more than once: split or diced by the first that needs it, and freed
// after the last of its buckets (decision 5).  Those that one bucket wants once never come here;
// the bucket owns them.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/once.h"
#include "base/statistics.h"
#include "dice/primitive.h"
#include "hider/grid_sweep.h"
#include "render/bucket_ends.h"
#include "shade/shading_system.h"

namespace granita {

class SharedGrid;
using HiddenGrids = std::vector<std::shared_ptr<SharedGrid>>;  ///< in a hider's arrival order

/// A diced grid and its slots, each filled once whoever asks first.
class SharedGrid {
  public:
    SharedGrid(std::unique_ptr<Grid> grid, Statistics& statistics);
    ~SharedGrid();
    const Grid& grid() const { return *m_grid; }
    /// With what it tells.
    std::uint64_t bytes() const;
    void ensure_opacity(const ShadingSystem& shading, Statistics& statistics);
    /// What it tells grids around it (Grid::told).
    void ensure_told(const ShadingSystem& shading, Statistics& statistics);
    /// `around`: makes the grids that tell it something, where it asks for them, in the order of
    /// their keys.  `stays`: a later picture may shade it anew.
    void ensure_radiance(const ShadingSystem& shading, Statistics& statistics,
                         const std::function<HiddenGrids()>& around, bool stays = false);
    /// Where its points are at the frame time, in camera space, and how far the next is, at most.
    struct Place {
        Bounds3f box;
        float step = 0.0f;

        bool is_within(float reach, const Place& other) const {
            for (int c = 0; c < 3; ++c)
                if (other.box.lo[c] > box.hi[c] + reach || other.box.hi[c] < box.lo[c] - reach)
                    return false;
            return true;
        }
    };
    const Place& place(Statistics& statistics);
    /// The picture is done, and what was begun of a grid that only tells others is not needed.
    void drop_begun() { m_begun.reset(); }
    /// Whether its shading state is not there and a later picture could not make it.
    bool asks_picture() const { return m_grid->state_asks_displacement && m_grid->shading_state; }
    void ensure_shading_state(Statistics& statistics);
    /// Between two pictures: the next one shades it anew.
    void forget_radiance();
    /// What hiding must know of it, once its opacity is there where that varies.
    const GridSweep& sweep(const Projection& projection, const LensShape& lens);

  private:
    void drop_radiance();
    void count_bytes();

    std::unique_ptr<Grid> m_grid;
    Statistics& m_statistics;
    std::uint64_t m_bytes = 0;
    std::optional<GridSweep> m_sweep;
    Place m_place;
    std::shared_ptr<GridShading> m_begun;
    Once m_has_state, m_has_place, m_opacity, m_has_sweep, m_told, m_radiance;
};

/// Splits until diceable and dices, with the counters.  nullptr when nothing is left of it.
std::shared_ptr<SharedGrid> dice_counted(const Primitive& primitive, Statistics& statistics);
std::vector<std::unique_ptr<Primitive>> split_counted(const Primitive& primitive,
                                                      Statistics& statistics);

class GeometryNode : public std::enable_shared_from_this<GeometryNode> {
  public:
    /// `buckets`: those that want it, bucket coordinates.
    GeometryNode(std::unique_ptr<Primitive> primitive, const Rect& buckets);

    /// Where a bucket asks whether it wants a child it reads this alone: nodes lie all over memory.
    struct Child {
        Rect buckets;
        RasterBounds bounds;
        std::shared_ptr<GeometryNode> node;
    };
    struct Content {
        std::vector<Child> children;
        std::shared_ptr<SharedGrid> grid;
    };
    /// The children or the grid, made at the first call; they stay until the last of its buckets
    /// has ended.  Thread-safe, for buckets that want it.
    const Content& expand(const BucketLayout& layout, BucketEnds& ends, Statistics& statistics);
    bool is_expanded() const { return m_expanded.load(std::memory_order_acquire); }
    void free() { m_content = {}; }
    const Rect& buckets() const { return m_buckets; }
    /// As Primitive::knot_boxes().
    const std::vector<Bounds3f>& knot_boxes() const { return m_knot_boxes; }

  private:
    std::mutex m_mutex;  ///< of whoever expands it
    std::atomic<bool> m_expanded{false};
    Rect m_buckets;
    std::vector<Bounds3f> m_knot_boxes;
    std::unique_ptr<Primitive> m_primitive;
    Content m_content;
};

}  // namespace granita
