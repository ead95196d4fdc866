// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hider/sample_lists.h"
#include "hider/sample_store.h"
#include "hider/samples/sample_order.h"
#include "hider/simd/depth_blocks.h"
#include "hider/simd/simd_kernel.h"

namespace granita {

/// A tile while the SIMD executor works on it: copies of its samples in the kernel's order.
class WorkingTile {
  public:
    WorkingTile() = default;
    WorkingTile(const WorkingTile&) = delete;
    WorkingTile& operator=(const WorkingTile&) = delete;

    /// Nothing seen yet.  `lens`: lens radius times pixels per unit shear, multiplied into u and v.
    /// The samples stay where they are, and may get times, until store_surfaces(); `memory`, of the
    /// lists, longer than these.
    void begin(const TileSamples& samples, const Rect& pixels, Vec2f lens, const OrderShape& shape,
               Arena& memory);

    const OrderShape& shape() const { return m_order.shape(); }
    /// Another order of the samples; what was seen moves along.
    void reorder(const TileSamples& samples, const OrderShape& shape);
    SimdTile view();
    /// A grid with transparent micropolygons comes.
    void prepare_lists() { lists.prepare(m_order.slots(), *m_memory); }
    /// Moves the lists to the store.
    void store_lists(TileStore& out);
    /// Moves the surfaces to the store, in table order; the last that is done with the tile.
    void store_surfaces(TileStore& out);
    OpaqueSurfaces surfaces() { return {m_key.data(), m_id.data()}; }
    /// Another grid with transparent micropolygons was hidden, of which `arrived` fragments came.
    /// Once there are `z_batch_size` of them and the fragments have grown by half, looks for
    /// samples whose list has ended, drops what is behind and has the depth hide what is still to
    /// come there.
    void end_lists(std::uint64_t arrived, const GridPool& pool, const ListEnd& end,
                   int z_batch_size);
    /// Brings the hierarchical depth up to date when it is worth while.
    void update_depth() { m_depth.update(m_key.data()); }
    void note_writes(std::uint64_t written) {
        m_depth.note_writes(written);
        if (written > 0) m_misses = 0;
    }
    /// Whether all samples of these pixels (relative to the tile) and times see something nearer.
    bool hides(const Rect& pixels, float time0, float time1, float nearest_key) const {
        return m_depth.hide(pixels.intersect(m_pixels), time0, time1, nearest_key);
    }

    /// Something that is yet to be diced was not hidden.  True: the hierarchical depth lagged and
    /// was brought up to date, so that it is worth while to ask again.  What is drawn comes from
    /// front to back: after a few such misses without a sample seen, what still lags hides the
    /// rest.
    bool refresh_depth() {
        constexpr int kPatience = 4;
        if (!m_depth.lags() || ++m_misses < kPatience) return false;
        m_depth.rebuild(m_key.data());
        return true;
    }

    /// Whether it is worth while to ask hides() more than once.
    bool hides_something() const { return m_depth.filled(); }

    FragmentLists lists;  ///< by slot of the order

  private:
    void arrange(const TileSamples& samples, const OrderShape& shape);

    const TileSamples* m_samples = nullptr;
    Rect m_pixels;
    Vec2f m_lens;
    SampleOrder m_order;
    DepthBlocks m_depth;
    std::vector<float> m_x, m_y, m_t, m_u, m_v;  ///< unless the order is the table's
    std::vector<float> m_inverse_focus, m_key;
    std::vector<SurfaceId> m_id;
    StratumBounds m_bounds;
    Arena* m_memory = nullptr;
    int m_misses = 0;                                     ///< since a sample saw something
    int m_grids_since = 0;                                ///< end_lists() looked at the lists
    std::uint64_t m_fragments = 0, m_fragments_then = 0;  ///< now, at most; and that were left
};

}  // namespace granita
