// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/working_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace granita {

void WorkingTile::begin(const TileSamples& samples, const Rect& pixels, Vec2f lens,
                        const OrderShape& shape, Arena& memory) {
    m_pixels = pixels;
    m_lens = lens;
    m_memory = &memory;
    m_misses = m_grids_since = 0;
    m_fragments = m_fragments_then = 0;
    arrange(samples, shape);
    lists.reset();
    m_id.assign(m_order.slots(), kNoSurface);
    m_key.assign(m_order.slots(), -INFINITY);
    // A slot without sample is nearer than everything, so that it never keeps a block from hiding.
    for (std::size_t i = 0; i < m_order.table_index().size(); ++i)
        if (m_order.table_index()[i] == SampleOrder::kNone) m_key[i] = INFINITY;
}

void WorkingTile::arrange(const TileSamples& samples, const OrderShape& shape) {
    m_samples = &samples;
    m_order.arrange(samples, m_pixels, shape);
    m_depth.reset(m_order, m_bounds);
    if (m_order.is_table()) return;
    const std::vector<std::uint32_t>& index = m_order.table_index();
    const auto copy = [&](const std::vector<float>& from, float factor, float none,
                          std::vector<float>& to) {
        to.assign(from.empty() ? 0 : index.size(), none);
        if (from.empty()) return;
        for (std::size_t i = 0; i < index.size(); ++i)
            if (index[i] != SampleOrder::kNone) to[i] = from[index[i]] * factor;
    };
    // A slot without sample is nowhere: not a number, hence inside of nothing.
    constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
    copy(samples.x, 1.0f, kNowhere, m_x);
    copy(samples.y, 1.0f, kNowhere, m_y);
    copy(samples.t, 1.0f, kNowhere, m_t);
    copy(samples.u, m_lens.x, kNowhere, m_u);
    copy(samples.v, m_lens.y, kNowhere, m_v);
    copy(samples.inverse_focus, 1.0f, kNowhere, m_inverse_focus);
    if (m_order.shape().stratified)
        m_bounds = bound_strata(m_order, m_t, m_u, m_v, m_inverse_focus);
}

void WorkingTile::reorder(const TileSamples& samples, const OrderShape& shape) {
    const SampleOrder before = m_order;
    TileStore seen;
    seen.key.resize(samples.x.size());
    seen.id.resize(samples.x.size());
    store_surfaces(seen);
    arrange(samples, shape);
    std::vector<std::uint32_t> slot(samples.x.size(), 0);  // by index in the table
    m_key.assign(m_order.slots(), INFINITY);
    m_id.assign(m_order.slots(), kNoSurface);
    for (std::uint32_t i = 0; i < m_order.slots(); ++i) {
        const std::uint32_t index = m_order.index(i);
        if (index == SampleOrder::kNone) continue;
        slot[index] = i;
        m_key[i] = seen.key[index];
        m_id[i] = seen.id[index];
    }
    FragmentLists from;
    std::swap(lists, from);
    if (!from.empty()) {
        prepare_lists();
        for (std::uint32_t i = 0; i < before.slots(); ++i)
            for (std::uint32_t k = 0; k < from.counts()[i]; ++k)
                lists.add(slot[before.index(i)], from.at(i, k));
        from.clear();
    }
    m_depth.rebuild(m_key.data());
}

SimdTile WorkingTile::view() {
    SimdTile tile;
    const bool is_table = m_order.is_table();
    tile.x = is_table ? m_samples->x.data() : m_x.data();
    tile.y = is_table ? m_samples->y.data() : m_y.data();
    tile.t = m_t.data();
    tile.u = m_u.data();
    tile.v = m_v.data();
    tile.inverse_focus = m_inverse_focus.data();
    tile.key = m_key.data();
    tile.id = m_id.data();
    tile.stratified = m_order.shape().stratified;
    tile.blocks_wide = m_order.blocks_wide();
    tile.strata = m_order.strata();
    tile.stratum_stride = static_cast<int>(m_order.stratum_stride());
    tile.packets = m_order.packets().data();
    tile.bounds = &m_bounds;
    tile.farthest_of_packets = m_depth.farthest_of_packets();
    tile.farthest_of_strata = m_depth.farthest_of_strata();
    tile.nearest_of_strata = m_depth.nearest_of_strata();
    tile.square_shift = m_depth.square_shift();
    tile.squares_wide = m_depth.squares_wide();
    return tile;
}

void WorkingTile::end_lists(std::uint64_t arrived, const GridPool& pool, const ListEnd& end,
                            int z_batch_size) {
    m_fragments += arrived;
    if (++m_grids_since < z_batch_size ||
        !worth_cutting(m_fragments, m_fragments_then, m_key.size()))
        return;
    m_grids_since = 0;
    const std::vector<float> before = m_key;
    sort_lists(lists, surfaces(), pool, end);
    m_fragments = m_fragments_then = lists.total();
    std::uint64_t ended = 0;
    for (std::size_t i = 0; i < before.size(); ++i) ended += before[i] != m_key[i];
    m_depth.note_writes(ended);
}

void WorkingTile::store_lists(TileStore& out) {
    std::swap(out.lists, lists);  // the store's were empty
    if (!out.lists.empty()) out.lists.order = m_order.table_index();
}

void WorkingTile::store_surfaces(TileStore& out) {
    if (m_order.is_table()) {
        out.key.swap(m_key);
        out.id.swap(m_id);
        return;
    }
    const std::vector<std::uint32_t>& index = m_order.table_index();
    for (std::size_t i = 0; i < index.size(); ++i) {
        if (index[i] == SampleOrder::kNone) continue;
        out.key[index[i]] = m_key[i];
        out.id[index[i]] = m_id[i];
    }
}

}  // namespace granita
