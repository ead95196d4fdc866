// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/tile_colors.h"

#include <algorithm>
#include <functional>

#include "base/stage_timer.h"
#include "film/tile_noise.h"
#include "hider/resolve/composite.h"
#include "render/background.h"
#include "render/tile_volumes.h"

namespace granita {

void TileColors::composite(const TileStore& store, const TileSamples& samples, LayerTable& layers,
                           const RefinedSamples& refined) {
    m_frame.progress.check();
    const Options& options = m_frame.scene.options;
    const ChannelSet& channels = m_frame.film.channels();
    const Scene* const catchers = m_frame.has_catchers ? &m_frame.scene : nullptr;
    const bool cut = channels.find(Quantity::Caught) != nullptr;
    const auto catches = [&](SurfaceId id) {
        const Grid& grid = layers.pool().grid(layers.pool().slot(id));
        return catchers->catches_shadows(grid.instance, grid.material);
    };
    std::function<bool(SurfaceId)> shows;
    if (catchers && (!cut || channels.has_environment())) shows = catches;
    std::vector<Vec3f> background{Vec3f(0.0f)};
    if (!options.film_transparent || channels.has_environment()) {
        const StageTimer timer(m_frame.statistics, Stage::Shade);
        background = tile_background(m_frame.scene.camera, m_table, m_frame.shading,
                                     m_frame.constant_background, store, shows);
    }
    const StageTimer timer(m_frame.statistics, Stage::Resolve);
    const CompositeSettings settings{m_frame.view.projection,
                                     m_frame.hider.list_end,
                                     options.film_transparent,
                                     &channels,
                                     options.depth_pass,
                                     catchers,
                                     cut};
    if (!m_frame.shading.volumes()) {
        composite_tile(store, samples, layers, background, settings, m_colors, &m_channels,
                       refined);
        return;
    }
    // Where the film shows the world behind shadow catchers, its fog lies before it, as in Cycles
    // (and with it what fills things there, which Cycles leaves out).
    const bool fogged = !options.film_transparent && m_frame.scene.world.is_filled();
    std::function<bool(SurfaceId)> shows_fogged;
    if (catchers && !cut && fogged) shows_fogged = catches;
    const TileVolumes volumes(m_frame, m_table, store, layers.pool(), refined, shows_fogged);
    composite_tile(store, samples, layers, background, settings, m_colors, &m_channels,
                   volumes.refined, volumes.samples);
}

void TileColors::take(const TileColors& part, const Rect& pixels, int samples) {
    m_colors.resize(part.m_colors.size());
    m_channels.filtered.resize(part.m_channels.filtered.size());
    m_channels.center.resize(part.m_channels.center.size());
    const ChannelSet& channels = m_frame.film.channels();
    // Pixels of a row follow each other, and so do their samples.
    const auto copy = [&](const std::vector<float>& from, std::vector<float>& to, int width) {
        for (int y = pixels.y0; y < pixels.y1; ++y) {
            const std::ptrdiff_t row = y * kTileSize;
            std::copy(from.begin() + (row + pixels.x0) * width,
                      from.begin() + (row + pixels.x1) * width,
                      to.begin() + (row + pixels.x0) * width);
        }
    };
    for (std::vector<float> SampleColors::*plane :
         {&SampleColors::red, &SampleColors::green, &SampleColors::blue, &SampleColors::alpha,
          &SampleColors::depth})
        copy(part.m_colors.*plane, m_colors.*plane, samples);
    if (channels.empty()) return;
    copy(part.m_channels.filtered, m_channels.filtered, samples * channels.sample_width());
    copy(part.m_channels.center, m_channels.center, channels.center_width());
}

ResolvedTile TileColors::resolve(Vec2i tile, const TileSamples& samples) const {
    const bool is_last = m_table.samples() == m_frame.levels.all().samples();
    return {filter(tile, samples), is_last ? 0.0f : tile_noise(samples, m_colors)};
}

TileContribution TileColors::filter(Vec2i tile, const TileSamples& samples) const {
    const StageTimer timer(m_frame.statistics, Stage::Resolve);
    TileContribution contribution = m_frame.film.filter_tile(tile, samples, m_colors, &m_channels);
    const Rect& own = contribution.own;
    if (!own.empty())
        m_frame.statistics.add(Counter::SamplesTotal,
                               static_cast<std::uint64_t>(own.width()) *
                                   static_cast<std::uint64_t>(own.height()) *
                                   static_cast<std::uint64_t>(samples.samples));
    return contribution;
}

}  // namespace granita
