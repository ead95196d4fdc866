// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/refine_samples.h"

#include <algorithm>
#include <span>

#include "base/parallel.h"
#include "base/stage_timer.h"
#include "hider/resolve/layer_kernel.h"
#include "hider/resolve/surface_interpolator.h"
#include "render/sample_place.h"

namespace granita {
namespace {

/// Points that are shaded at once.
constexpr std::size_t kBatch = 1024;
/// Least chance of a layer that all of the light reaches: its own opacity may be more than that
/// between its corners.
constexpr float kLeastChance = 1.0f / 16.0f;

constexpr std::uint64_t kStarts = 0x6c61796572ULL;

float mean_of(const Vec3f& v) {
    return (v.x + v.y + v.z) / 3.0f;
}

bool is_within(const Vec3f& opacity, const OpacityBounds& bounds) {
    return std::min({opacity.x, opacity.y, opacity.z}) >= bounds.least &&
           mean_of(opacity) <= bounds.most;
}

}  // namespace

BucketRefinement::BucketRefinement(Frame& frame, const Hider& hider,
                                   const std::vector<TileStore>& stores,
                                   const std::vector<bool>& seen)
    : m_frame(frame),
      m_hider(hider),
      m_pool(hider.pool()),
      m_stores(stores),
      m_channels(frame.film.channels()),
      m_shows_first(m_channels.vertex_width() > m_channels.layers_width()),
      m_starts(SobolPoints(frame.scene.options.seed + kStarts).shuffled(kStarts)),
      m_times(stores.size()),
      m_tiles(stores.size()) {
    const StageTimer timer(frame.statistics, Stage::Shade);
    m_unsettled.resize(m_pool.size(), 0);
    bool any = false;
    for (std::uint32_t slot = 0; slot < m_pool.size(); ++slot)
        if (seen[slot] && !m_pool.grid(slot).unsettled.empty()) {
            m_unsettled[slot] = 1;
            any = true;
        }
    if (!any) return;
    for (std::uint32_t tile = 0; tile < stores.size(); ++tile) find_behind(tile);
    if (!m_wanted.empty()) keep_behind();
    for (std::uint32_t tile = 0; tile < stores.size(); ++tile) find_lists(tile);
    while (!m_open.empty()) {
        m_wanted.clear();
        std::size_t left = 0;
        for (std::size_t i = 0; i < m_open.size(); ++i) {
            m_open[left] = m_open[i];
            left += find_layer(left) ? 1 : 0;
        }
        m_open.resize(left);
        if (!m_wanted.empty()) keep_layers();
    }
}

bool BucketRefinement::is_unsettled(SurfaceId id) const {
    if (!m_unsettled[m_pool.slot(id)]) return false;
    const GridPool::Place place = m_pool.locate(id);
    return place.grid->unsettled[static_cast<std::size_t>(place.micropolygon)] != 0;
}

void BucketRefinement::want(SurfaceId id, std::uint32_t tile, std::uint32_t sample,
                            std::size_t list, const SurfacePoint& at) {
    const int samples = m_hider.tile_samples(tile).samples;
    Wanted one{m_pool.slot(id), tile, sample, list, {}};
    for (int k = 0; k < 3; ++k) {
        one.point.vertex[k] = static_cast<std::uint32_t>(at.vertex[k]);
        one.point.weight[k] = at.weight[k];
    }
    one.point.place = place_of(m_stores[tile].tile, sample, samples);
    if (!m_times[tile].known) find_times(tile);
    const TileTimes& times = m_times[tile];
    const bool timed = !times.of_samples.empty() &&
                       times.matters[sample / static_cast<std::uint32_t>(samples)] != 0;
    one.point.time = timed ? times.of_samples[sample] : kAnyTime;
    m_wanted.push_back(one);
}

/// Where nothing that a pixel sees moves, times do not matter: nor does whether they were made.
/// What goes along with the camera moves too, though the bucket that sees it has made none.
void BucketRefinement::find_times(std::uint32_t tile) {
    const TileStore& store = m_stores[tile];
    const TileSamples& samples = m_hider.tile_samples(tile);
    const auto count = static_cast<std::size_t>(samples.samples);
    TileTimes& out = m_times[tile];
    out.known = true;
    const bool camera_moves = m_frame.scene.camera.world_from_camera.size() > 1;
    if (!camera_moves && samples.t.empty()) return;
    out.of_samples = samples.t;
    out.matters.assign(store.id.size() / count, camera_moves);
    if (camera_moves) {
        if (!samples.t.empty()) return;
        TileSamples frame_samples = samples;
        m_hider.table().fill_times(store.tile, frame_samples);
        out.of_samples = std::move(frame_samples.t);
        return;
    }
    for (std::size_t s = 0; s < store.id.size(); ++s)
        if (store.id[s] != kNoSurface && moves(store.id[s])) out.matters[s / count] = 1;
    const FragmentLists& lists = store.lists;
    for (std::uint32_t slot = 0; slot < lists.slots() && !lists.empty(); ++slot)
        for (std::uint32_t k = 0; k < lists.counts()[slot]; ++k)
            if (moves(lists.at(slot, k).id)) out.matters[lists.sample(slot) / count] = 1;
}

void BucketRefinement::find_behind(std::uint32_t tile) {
    const TileStore& store = m_stores[tile];
    SurfaceInterpolator surfaces(m_frame.view.projection, store.tile, m_hider.tile_samples(tile),
                                 m_pool);
    SurfaceId last = kNoSurface;
    bool last_unsettled = false;
    for (std::uint32_t s = 0; s < store.id.size(); ++s) {
        const SurfaceId id = store.id[s];
        if (id == kNoSurface) continue;
        if (id != last) {
            last = id;
            last_unsettled = is_unsettled(id);
        }
        if (last_unsettled) want(id, tile, s, 0, surfaces.locate(s, id));
    }
}

void BucketRefinement::find_lists(std::uint32_t tile) {
    const FragmentLists& lists = m_stores[tile].lists;
    const int samples = m_hider.tile_samples(tile).samples;
    for (std::uint32_t slot = 0; slot < lists.slots() && !lists.empty(); ++slot)
        for (std::uint32_t k = 0; k < lists.counts()[slot]; ++k)
            if (is_unsettled(lists.at(slot, k).id)) {
                const auto place = place_of(m_stores[tile].tile, lists.sample(slot), samples);
                m_open.push_back({tile, slot, 0, LayerChoice(m_starts(place).x)});
                break;
            }
}

/// What the light of a layer that only samples shade counts; 0: it is not taken.
float BucketRefinement::weight_of(OpenList& list, const Vec3f& opacity) const {
    const float reached = mean_of(list.transmission);
    if (reached <= 0.0f) return 0.0f;
    return list.choice.weight(
        std::max(mean_of(list.transmission * opacity), kLeastChance * reached));
}

/// Goes on to the list's next layer that is to be shaded; false where none is left that is seen.
/// Layer by layer, as all layers of foliage would be twenty times as many as are seen.
bool BucketRefinement::find_layer(std::size_t list) {
    OpenList& open = m_open[list];
    const FragmentLists& lists = m_stores[open.tile].lists;
    const Options& options = m_frame.scene.options;
    for (; open.next < lists.counts()[open.slot]; ++open.next) {
        const bool has_ended = largest(open.transmission) <= 1.0f - options.opacity_threshold;
        if (has_ended && (open.has_first || !m_shows_first)) return false;
        const Fragment fragment = lists.at(open.slot, open.next);
        const SurfacePoint at = point_of(fragment, m_pool);
        const Vec3f opacity = glm::clamp(at(at.grid->opacity), 0.0f, 1.0f);
        const double mean = channel_mean(opacity.x, opacity.y, opacity.z);
        const bool is_first = !open.has_first && mean > 0.0 && mean >= options.pass_alpha_threshold;
        open.has_first = open.has_first || is_first;
        if (is_unsettled(fragment.id)) {
            const bool left = is_left(*at.grid);
            const bool chooses = left && !at.grid->additive;
            const float weight = has_ended ? 0.0f : chooses ? weight_of(open, opacity) : 1.0f;
            if (weight > 0.0f || (is_first && left && m_shows_first)) {
                want(fragment.id, open.tile, lists.sample(open.slot), list, at);
                m_wanted.back().weight = weight;
                return true;
            }
        }
        open.transmission *= Vec3f(1.0f) - opacity;
    }
    return false;
}

/// Sorts what is wanted by grid; returns the batches in that order.
std::vector<Grid> BucketRefinement::shade() {
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
    std::vector<Grid> shaded(batches.size());
    parallel_for(batches.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::vector<RefinedPoint> points;
        for (std::size_t b = begin; b < end; ++b) {
            m_frame.progress.check();
            points.clear();
            for (std::size_t i = batches[b].begin; i < batches[b].end; ++i)
                points.push_back(m_wanted[i].point);
            const Grid& grid = m_pool.grid(m_wanted[batches[b].begin].slot);
            const Stopwatch watch;
            shaded[b] = m_frame.shading.refine(grid, points);
            m_frame.statistics.objects().add_seconds(grid.instance, watch.seconds());
        }
    });
    return shaded;
}

/// What hiding took for opaque is: where a sample finds less, its light is that of the corners.
void BucketRefinement::keep_behind() {
    m_shaded.push_back(shade());
    auto next = m_wanted.begin();
    for (const Grid& grid : m_shaded.back())
        for (int v = 0; v < grid.vertex_count(); ++v, ++next)
            if (grid.opacity.empty() || is_left(m_pool.grid(next->slot)) ||
                is_within(grid.opacity[v], {1.0f, 1.0f}))
                m_tiles[next->tile].add(next->sample, m_stores[next->tile].id.size(), grid, v);
}

/// A layer stays as it was where its opacity is not what the ends of lists have gone by.  What only
/// samples shade has that of its corners.
void BucketRefinement::keep_layers() {
    std::vector<Grid> shaded = shade();
    auto next = m_wanted.begin();
    for (Grid& grid : shaded)
        for (int v = 0; v < grid.vertex_count(); ++v, ++next) {
            OpenList& open = m_open[next->list];
            const FragmentLists& lists = m_stores[open.tile].lists;
            const Fragment fragment = lists.at(open.slot, open.next);
            const SurfacePoint at = point_of(fragment, m_pool);
            Vec3f opacity = at(at.grid->opacity);
            const bool left = is_left(*at.grid);
            if (left || is_within(grid.opacity[v], m_pool.opacity(fragment.id))) {
                if (!left) opacity = grid.opacity[v];
                weigh(grid, v, next->weight);
                m_tiles[open.tile].add_layer(lists, open.slot, open.next,
                                             look_of(opacity, grid.radiance[v], at.grid->holdout),
                                             m_channels.empty() ? nullptr : &grid, v);
            }
            open.transmission *= Vec3f(1.0f) - glm::clamp(opacity, 0.0f, 1.0f);
            ++open.next;
        }
    // Only channels are read again.
    if (!m_channels.empty()) m_shaded.push_back(std::move(shaded));
}

/// Radiance, and what passes add up as it.
void BucketRefinement::weigh(Grid& grid, int vertex, float weight) const {
    if (weight == 1.0f) return;
    grid.radiance[vertex] *= weight;
    float* const row = grid.channels.data() + vertex * m_channels.vertex_width();
    for (int c = 0; c < m_channels.layers_width(); ++c) row[c] *= weight;
}

}  // namespace granita
