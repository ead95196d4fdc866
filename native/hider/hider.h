// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility of one bucket: one interface, several executors (docs/decisions/hiding.md).
//
//   auto hider = make_hider(executor, frame, tiles);
//   for primitives from front to back:  if (!hider->occluded(bounds)) ... hider->hide(sweep)
//   for (TileStore& tile : hider->finish()) ...        // the samples, for compositing
//
// `hide` reads positions, and opacity where Grid::opacity_varies; never radiance: shading comes
// after visibility. An object of this class belongs to one task; the frame is shared and immutable.
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "base/statistics.h"
#include "dice/grid.h"
#include "hider/grid_sweep.h"
#include "hider/sample_lists.h"
#include "hider/sample_store.h"
#include "hider/samples/sample_table.h"
#include "hider/time_slabs.h"
#include "math/projection.h"

namespace granita {

struct HiderFrame {
    const SampleTable* table = nullptr;
    Projection projection;
    Statistics* statistics = nullptr;
    /// Where dropped micropolygons are named; both or neither.
    const Scene* scene = nullptr;
    Report* report = nullptr;
    const Progress* progress = nullptr;  ///< asked between tiles; may be absent
    ListEnd list_end{};  ///< that of compositing, so that what it never follows is left out
    std::uint64_t list_bytes = ~std::uint64_t{0};  ///< that lists may take, see overflowed()
    int z_batch_size = 26;  ///< transparent grids after which lists are looked through for ends
};

class Hider {
  public:
    explicit Hider(const HiderFrame& frame)
        : m_projection(frame.projection), m_table(*frame.table), m_lens(m_table.lens()) {}
    virtual ~Hider() = default;
    /// True only if nothing inside the bounds can be seen by any sample of the bucket, given what
    /// was hidden so far.
    bool occluded(const RasterBounds& bounds) const { return occluded(TimeSlab{0, 1, bounds}); }
    /// The same for what is there during a part of the shutter.
    virtual bool occluded(const TimeSlab& slab) const = 0;
    /// The sweep's grid must outlive the hider.
    virtual void hide(const GridSweep& sweep) = 0;
    /// One that no other hider asks for.
    void hide(const Grid& grid) { hide(GridSweep(grid, m_projection, m_lens)); }
    /// The lists were given up because they took more than HiderFrame::list_bytes.  Opaque surfaces
    /// and occlusion hold; hiders of fewer pixels are to hide the same grids.
    virtual bool overflowed() const = 0;
    /// In raster order of tiles.  No hide() afterwards.
    virtual std::vector<TileStore>& finish() = 0;
    virtual const GridPool& pool() const = 0;
    const SampleTable& table() const { return m_table; }
    /// Of the pool's grids, by arrival, those that some sample of finish() sees.
    virtual std::vector<bool> seen_grids() const = 0;
    /// The samples of a tile of finish(), by index: made with exactly the needs that the bucket
    /// met.
    virtual const TileSamples& tile_samples(std::size_t tile_index) const = 0;
    /// Of what is kept after finish(): samples are three quarters of its memory, and cheap to make.
    /// Their table must still be there.
    virtual void drop_samples() = 0;
    virtual void make_samples() = 0;

  protected:
    const Projection m_projection;
    const SampleTable& m_table;
    const LensShape& m_lens;
};

/// `tiles`: rectangle in tile coordinates; `pixels`: only samples of these pixels count (the crop
/// and its margin).
std::unique_ptr<Hider> make_reference_hider(const HiderFrame& frame, const Rect& tiles,
                                            const Rect& pixels);
std::unique_ptr<Hider> make_simd_hider(const HiderFrame& frame, const Rect& tiles,
                                       const Rect& pixels);

}  // namespace granita
