// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/refine_samples.h"

#include <algorithm>
#include <span>

#include "base/parallel.h"
#include "base/stage_timer.h"
#include "hider/resolve/surface_interpolator.h"
#include "math/sampling.h"

namespace granita {
namespace {

/// Points that are shaded at once.
constexpr std::size_t kBatch = 1024;

/// In the sample sequences of the frame: pixels along Morton's curve, whose aligned squares are
/// stratified as one.
std::uint32_t place_of(Vec2i tile, std::uint32_t sample, int samples) {
    const std::uint32_t pixel = sample / static_cast<std::uint32_t>(samples);
    const auto x = static_cast<std::uint32_t>(tile.x * kTileSize) + pixel % kTileSize;
    const auto y = static_cast<std::uint32_t>(tile.y * kTileSize) + pixel / kTileSize;
    return morton_index(x, y) * static_cast<std::uint32_t>(samples) +
           sample % static_cast<std::uint32_t>(samples);
}

}  // namespace

BucketRefinement::BucketRefinement(Frame& frame, const Hider& hider,
                                   const std::vector<TileStore>& stores,
                                   const std::vector<bool>& seen)
    : m_frame(frame), m_pool(hider.pool()), m_stores(stores), m_tiles(stores.size()) {
    const StageTimer timer(frame.statistics, Stage::Shade);
    m_unsettled.resize(m_pool.size(), 0);
    bool any = false;
    for (std::uint32_t slot = 0; slot < m_pool.size(); ++slot)
        if (seen[slot] && !m_pool.grid(slot).unsettled.empty()) {
            m_unsettled[slot] = 1;
            any = true;
        }
    if (!any) return;
    for (std::size_t i = 0; i < stores.size(); ++i)
        find(stores[i], hider.tile_samples(i), static_cast<std::uint32_t>(i));
    if (!m_wanted.empty()) shade();
}

/// Whether any of these surfaces moves.
bool BucketRefinement::any_moves(std::span<const SurfaceId> ids) const {
    return std::ranges::any_of(ids, [this](SurfaceId id) {
        return id != kNoSurface && m_pool.grid(m_pool.slot(id)).motion;
    });
}

/// The same of what is in lists.
bool BucketRefinement::any_moves(const FragmentLists& lists) const {
    for (std::size_t packet = 0; packet < lists.packets() && !lists.empty(); ++packet)
        for (std::uint32_t lane = 0; lane < FragmentLists::kLanes; ++lane)
            for (std::uint32_t k = 0; k < lists.counts()[packet * FragmentLists::kLanes + lane];
                 ++k)
                if (any_moves({&lists.layer(packet, k).head[lane].id, 1})) return true;
    return false;
}

bool BucketRefinement::is_unsettled(SurfaceId id) const {
    if (!m_unsettled[m_pool.slot(id)]) return false;
    const GridPool::Place place = m_pool.locate(id);
    return place.grid->unsettled[static_cast<std::size_t>(place.micropolygon)] != 0;
}

void BucketRefinement::find(const TileStore& store, const TileSamples& samples,
                            std::uint32_t tile) {
    const std::size_t first = m_wanted.size();
    const auto want = [&](SurfaceId id, std::uint32_t sample, std::uint32_t list,
                          std::uint32_t layer, const SurfacePoint& at) {
        Wanted one{m_pool.slot(id), tile, sample, list, layer, {}};
        for (int k = 0; k < 3; ++k) {
            one.point.vertex[k] = static_cast<std::uint32_t>(at.vertex[k]);
            one.point.weight[k] = at.weight[k];
        }
        one.point.place = place_of(store.tile, sample, samples.samples);
        m_wanted.push_back(one);
    };
    SurfaceInterpolator surfaces(m_frame.view.projection, store.tile, samples, m_pool);
    SurfaceId last = kNoSurface;
    bool last_unsettled = false;
    for (std::uint32_t s = 0; s < store.id.size(); ++s) {
        const SurfaceId id = store.id[s];
        if (id == kNoSurface) continue;
        if (id != last) {
            last = id;
            last_unsettled = is_unsettled(id);
        }
        if (last_unsettled) want(id, s, 0, kBehind, surfaces.locate(s, id));
    }
    const FragmentLists& lists = store.lists;
    for (std::uint32_t slot = 0; slot < lists.slots() && !lists.empty(); ++slot)
        for (std::uint32_t k = 0; k < lists.counts()[slot]; ++k) {
            const Fragment fragment = lists.at(slot, k);
            if (is_unsettled(fragment.id))
                want(fragment.id, lists.sample(slot), slot, k, point_of(fragment, m_pool));
        }
    if (m_wanted.size() > first) set_times(store, samples, first);
}

/// Where nothing that is seen moves, times do not matter: nor does whether they were made.  What
/// goes along with the camera moves too, though the bucket that sees it has made none.
void BucketRefinement::set_times(const TileStore& store, const TileSamples& samples,
                                 std::size_t first) {
    const auto count = static_cast<std::uint32_t>(samples.samples);
    const bool camera_moves = m_frame.scene.camera.world_from_camera.size() > 1;
    TileSamples frame_samples;
    if (camera_moves && samples.t.empty()) {
        frame_samples = samples;
        m_frame.table.fill_times(store.tile, frame_samples);
    }
    const std::vector<float>& times =
        camera_moves && samples.t.empty() ? frame_samples.t : samples.t;
    const bool all_move = camera_moves || (!times.empty() && any_moves(store.lists));
    std::uint32_t pixel = ~0u;
    bool pixel_moves = false;
    for (std::size_t i = first; i < m_wanted.size(); ++i) {
        const std::uint32_t s = m_wanted[i].sample;
        if (s / count != pixel) {
            pixel = s / count;
            pixel_moves =
                all_move ||
                (!times.empty() && any_moves(std::span(store.id).subspan(pixel * count, count)));
        }
        m_wanted[i].point.time = pixel_moves ? times[s] : kAnyTime;
    }
}

void BucketRefinement::shade() {
    std::stable_sort(m_wanted.begin(), m_wanted.end(),
                     [](const Wanted& a, const Wanted& b) { return a.slot < b.slot; });
    struct Batch {
        std::size_t begin, end;
    };
    std::vector<Batch> batches;
    for (std::size_t i = 0; i < m_wanted.size(); ++i) {
        if (i == 0 || m_wanted[i].slot != m_wanted[i - 1].slot ||
            i - batches.back().begin == kBatch)
            batches.push_back({i, i});
        batches.back().end = i + 1;
    }
    m_shaded.resize(batches.size());
    parallel_for(batches.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::vector<RefinedPoint> points;
        for (std::size_t b = begin; b < end; ++b) {
            m_frame.progress.check();
            points.clear();
            for (std::size_t i = batches[b].begin; i < batches[b].end; ++i)
                points.push_back(m_wanted[i].point);
            m_shaded[b] =
                m_frame.shading.refine(m_pool.grid(m_wanted[batches[b].begin].slot), points);
        }
    });
    for (std::size_t b = 0; b < batches.size(); ++b)
        for (std::size_t i = batches[b].begin; i < batches[b].end; ++i)
            keep(m_wanted[i], m_shaded[b], static_cast<int>(i - batches[b].begin));
}

void BucketRefinement::keep(const Wanted& wanted, const Grid& shaded, int vertex) {
    RefinedSamples& tile = m_tiles[wanted.tile];
    const TileStore& store = m_stores[wanted.tile];
    if (wanted.layer == kBehind)
        tile.add(wanted.sample, store.id.size(), shaded, vertex);
    else
        tile.add_layer(store.lists, wanted.list, wanted.layer, shaded, vertex);
}

}  // namespace granita
