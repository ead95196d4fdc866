// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/composite.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>

#include "base/check.h"
#include "base/object_pool.h"
#include "hider/resolve/channel_layers.h"
#include "hider/resolve/layer_kernel.h"
#include "hider/resolve/surface_interpolator.h"
#include "scene/scene.h"

namespace granita {
namespace {

constexpr std::uint32_t kRun = SurfaceRun::kCount, kAll = (1u << kRun) - 1u;
constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// Of a run of samples that see surfaces without holdout.
void set_depth(const TileStore& store, const CompositeSettings& settings, std::uint32_t first,
               SampleColors& colors) {
    if (!settings.depth) return;
    for (int i = 0; i < SurfaceRun::kCount; ++i)
        colors.depth[first + i] = settings.projection.depth_from_key(store.key[first + i]);
}

/// Colours of a run of samples that see surfaces without holdout.
void set_opaque(const TileStore& store, const CompositeSettings& settings, std::uint32_t first,
                const SurfaceRun& run, SampleColors& colors) {
    const auto copy = [&](const float* from, std::vector<float>& to) {
        for (int i = 0; i < SurfaceRun::kCount; ++i) to[first + i] = from[i] + 0.0f;
    };
    copy(run.color[0], colors.red);
    copy(run.color[1], colors.green);
    copy(run.color[2], colors.blue);
    for (int i = 0; i < SurfaceRun::kCount; ++i) colors.alpha[first + i] = 1.0f;
    set_depth(store, settings, first, colors);
}

/// The samples of a run that see nothing.
void set_empty(std::uint32_t first, std::uint32_t seen, const SampleColor& empty,
               SampleColors& colors) {
    const float values[] = {empty.color.x, empty.color.y, empty.color.z, empty.alpha, empty.depth};
    std::vector<float>* const planes[] = {&colors.red, &colors.green, &colors.blue, &colors.alpha,
                                          &colors.depth};
    for (int k = 0; k < 5; ++k) {
        float* const to = planes[k]->data() + first;
        if (seen == 0) {
            std::fill_n(to, SurfaceRun::kCount, values[k]);
            continue;
        }
        for (int i = 0; i < SurfaceRun::kCount; ++i) to[i] = seen >> i & 1u ? to[i] : values[k];
    }
}

/// Composites the samples of one tile: first what is behind the lists, then the lists over it.
class TileComposite {
  public:
    TileComposite(const TileStore& store, const TileSamples& samples, LayerTable& table,
                  std::span<const Vec3f> background, const CompositeSettings& settings,
                  ChannelLayers* channels, const RefinedSamples& refined,
                  const SampleVolumes& volumes, SampleColors& colors)
        : m_store(store),
          m_samples(samples),
          m_table(table),
          m_background(background),
          m_settings(settings),
          m_channels(channels),
          m_refined(refined),
          m_volumes(volumes),
          m_colors(colors),
          m_blurred(!samples.t.empty() || !samples.u.empty()),
          m_surface(settings.projection, store.tile, samples, table.pool()) {}

    void run() {
        if (m_channels && !m_store.lists.empty()) mark_lists();
        if (!m_channels) color_surfaces();
        for (std::uint32_t first = 0; first < m_store.key.size(); first += kRun)
            if (m_done.empty() || !finish_run(first)) set_behind(first);
        set_refined();
        if (!m_volumes.empty()) put_volumes_over();
        if (m_store.lists.empty()) return;
        m_table.fill();
        for (std::size_t p = 0; p < m_store.lists.packets(); ++p) add_lists(p);
    }

  private:
    /// Channels of samples with lists wait for the layers in front.
    void mark_lists() {
        m_listed.assign(m_store.key.size(), false);
        for (std::uint32_t slot = 0; slot < m_store.lists.slots(); ++slot)
            if (m_store.lists.counts()[slot] > 0) m_listed[m_store.lists.sample(slot)] = true;
    }

    /// What does not depend on where runs of samples meet surfaces, or is found sooner by surface.
    void color_surfaces() {
        const GridColors& grids = m_table.grid_colors();
        if (!grids.any() && !m_blurred) return;
        m_done.assign(m_store.id.size(), 0);
        const bool rest = !grids.any() || grids.color(m_table.pool(), m_store.id, m_colors, m_done);
        if (!rest || !m_blurred) return;
        SurfaceGroups groups = ObjectPool<SurfaceGroups>::take();
        if (groups.sort(m_store.id, m_done)) {
            groups.take_samples(m_samples);
            m_surface.color_groups(groups, m_colors, m_done);
        }
        ObjectPool<SurfaceGroups>::give(std::move(groups));
    }

    /// Where channels are asked for, set_behind() has met them already.
    void set_refined() {
        if (m_channels) return;
        for (std::size_t i = 0; i < m_refined.samples().size(); ++i) {
            const std::uint32_t sample = m_refined.samples()[i];
            m_colors.set(sample, opaque(sample, m_refined.point(i)));
        }
    }

    void put_volumes_over() {
        for (std::uint32_t sample = 0; sample < m_store.key.size(); ++sample) {
            const SampleVolume& volume = m_volumes.behind(sample);
            SampleColor color = m_colors[sample];
            const Vec3f& left = volume.transmittance;
            color.color = volume.light() + left * color.color;
            color.alpha = static_cast<float>(1.0 - channel_mean(left.x, left.y, left.z) *
                                                       (1.0 - color.alpha));
            m_colors.set(sample, color);
        }
    }

    /// Where a sample meets the surface behind its list.
    SurfacePoint meet(std::uint32_t sample) {
        const SurfacePoint* const refined = m_refined.find(sample);
        return refined ? *refined : m_surface.locate(sample, m_store.id[sample]);
    }

    /// False where a sample of the run still wants its colour.
    bool finish_run(std::uint32_t first) {
        static constexpr std::array<std::uint8_t, kRun> kDone = [] {
            std::array<std::uint8_t, kRun> all;
            all.fill(1);
            return all;
        }();
        if (std::equal(kDone.begin(), kDone.end(), m_done.data() + first)) {
            set_depth(m_store, m_settings, first, m_colors);
            return true;
        }
        std::uint32_t done = 0, seen = 0;
        for (std::uint32_t i = 0; i < kRun; ++i) {
            done |= std::uint32_t{m_done[first + i]} << i;
            seen |= (m_store.id[first + i] != kNoSurface ? 1u : 0u) << i;
        }
        if (seen != done || (seen != kAll && m_background.size() > 1)) return false;
        set_depth(m_store, m_settings, first, m_colors);
        if (seen != kAll) set_empty(first, seen, nothing(first), m_colors);
        return true;
    }

    void set_behind(std::uint32_t first) {
        m_surface.locate_run(first, &m_store.id[first], m_channels != nullptr, m_run);
        // Most samples of most pictures: one opaque surface and nothing else.
        std::uint32_t done = 0;
        if (!m_channels && (m_run.plain & m_run.colored) != 0) {
            done = m_run.plain & m_run.colored;
            set_opaque(m_store, m_settings, first, m_run, m_colors);
        }
        if (!m_channels && m_background.size() <= 1 && m_run.seen != kAll) {
            set_empty(first, m_run.seen, nothing(first), m_colors);
            done |= kAll & ~m_run.seen;
        }
        for (std::uint32_t rest = kAll & ~done; rest != 0; rest &= rest - 1) {
            const int i = std::countr_zero(rest);
            const std::uint32_t sample = first + static_cast<std::uint32_t>(i);
            const bool listed = !m_listed.empty() && m_listed[sample];
            if (m_channels && !listed) add_light_of_volumes(sample, Vec3d(1.0));
            if (m_store.id[sample] == kNoSurface) {
                m_colors.set(sample, nothing(sample));
                if (m_channels && !listed) add_environment(sample, Vec3d(1.0));
                continue;
            }
            const bool known = m_channels && (m_run.plain >> i & 1u) && !m_refined.find(sample);
            const SurfacePoint point = known ? m_run.point(i) : meet(sample);
            m_colors.set(sample, opaque(sample, point));
            if (!m_channels || listed) continue;
            m_channels->set_first(sample, point);
            add_behind(sample, point, Vec3d(1.0));
        }
    }

    /// Behind a list that reached the threshold: black where the film shows a background.
    SampleColor end_of_list() const {
        SampleColor color;
        color.alpha = m_settings.film_transparent ? 0.0f : 1.0f;
        return color;
    }

    /// A sample that sees no surface.
    SampleColor nothing(std::uint32_t sample) const {
        SampleColor color;
        color.depth = std::numeric_limits<float>::infinity();
        if (m_settings.film_transparent) return color;
        color.color = m_background[m_background.size() == 1 ? 0 : sample];
        color.alpha = 1.0f;
        return color;
    }

    SampleColor opaque(std::uint32_t sample, const SurfacePoint& point) const {
        SampleColor color;
        color.depth = m_settings.projection.depth_from_key(m_store.key[sample]);
        if (catches(*point.grid) && !m_settings.catchers_cut)
            return caught(sample, point(point.grid->radiance), color.depth);
        if (point.grid->holdout) {
            if (!catches(*point.grid)) color.depth = std::numeric_limits<float>::infinity();
            return color;
        }
        if (!point.grid->radiance.empty()) color.color = point(point.grid->radiance);
        color.color += Vec3f(0.0f);  // no negative zeros
        color.alpha = 1.0f;
        return color;
    }

    bool catches(const Grid& grid) const {
        return m_settings.catchers && grid.holdout &&
               m_settings.catchers->catches_shadows(grid.instance, grid.material);
    }
    /// What is left of a shadow catcher's light, in all channels alike, as in Cycles: by that much
    /// it takes from what is, or will be, behind.
    SampleColor caught(std::uint32_t sample, const Vec3f& light, float depth) const {
        SampleColor color = nothing(sample);
        color.depth = depth;
        const auto mean = static_cast<float>(channel_mean(light.x, light.y, light.z));
        const float left = std::clamp(mean, 0.0f, 1.0f);
        color.color *= left;
        if (m_settings.film_transparent) color.alpha = 1.0f - left;
        return color;
    }

    // Of what is behind a sample's list; `transmission` of the list.

    /// Of light that is behind as well.
    Vec3d through_volumes(std::uint32_t sample, const Vec3d& transmission) const {
        if (m_volumes.empty()) return transmission;
        return transmission * Vec3d(m_volumes.behind(sample).transmittance);
    }
    void add_light_of_volumes(std::uint32_t sample, const Vec3d& transmission) {
        if (!m_volumes.empty())
            m_channels->add_volume(sample, m_volumes.behind(sample), transmission);
    }
    void add_environment(std::uint32_t sample, const Vec3d& transmission) {
        if (m_background.empty()) return;
        m_channels->add_environment(sample, m_background[m_background.size() == 1 ? 0 : sample],
                                    through_volumes(sample, transmission));
    }
    void add_behind(std::uint32_t sample, const SurfacePoint& point, const Vec3d& transmission) {
        const bool catches_shadows = catches(*point.grid);
        if (!point.grid->holdout || catches_shadows)
            m_channels->add(sample, point, through_volumes(sample, transmission));
        if (catches_shadows && !m_settings.film_transparent) add_environment(sample, transmission);
    }

    void add_lists(std::size_t packet) {
        const FragmentLists& lists = m_store.lists;
        const auto first = static_cast<std::uint32_t>(packet) * FragmentLists::kLanes;
        const std::uint32_t* const counts = lists.counts() + first;
        if (std::all_of(counts, counts + kPacket, [](std::uint32_t n) { return n == 0; })) return;
        std::optional<ListChannels> visitor;
        if (m_channels) visitor.emplace(lists, m_table.pool(), m_refined, m_volumes, *m_channels);
        PacketLayers layers;
        composite_packet(lists, packet, m_table, m_refined, m_settings.end,
                         visitor ? &*visitor : nullptr, layers);
        for (int i = 0; i < kPacket; ++i)
            if (counts[i] > 0)
                put_over(lists.sample(first + static_cast<std::uint32_t>(i)), layers, i);
    }

    /// The layers of a sample over what is behind them.
    void put_over(std::uint32_t sample, const PacketLayers& layers, int i) {
        const bool ended = (layers.ended >> i & 1u) != 0;
        const SampleColor surface = m_colors[sample];
        // What is behind the end of a list may have been culled, so that nothing is left of it: and
        // least of all the background, which shone through two sheets and a wall behind them.
        const SampleColor behind = ended ? end_of_list() : surface;
        const Vec3d transmission(layers.transmission[0][i], layers.transmission[1][i],
                                 layers.transmission[2][i]);
        const Vec3d color(layers.color[0][i], layers.color[1][i], layers.color[2][i]);
        const double rest = channel_mean(transmission.x, transmission.y, transmission.z);
        const double alpha = m_settings.film_transparent
                                 ? layers.alpha[i] + rest * behind.alpha
                                 : 1.0 - (layers.cut[i] + rest * (1.0 - behind.alpha));
        const bool found = layers.first_key[i] > kNothing;
        const bool is_cut = (layers.first_cuts >> i & 1u) != 0;
        m_colors.set(sample,
                     {Vec3f(color + transmission * Vec3d(behind.color)), static_cast<float>(alpha),
                      is_cut  ? std::numeric_limits<float>::infinity()
                      : found ? m_settings.projection.depth_from_key(layers.first_key[i])
                              : surface.depth});
        if (m_channels) put_channels_over(sample, transmission, found, ended);
    }

    void put_channels_over(std::uint32_t sample, const Vec3d& transmission, bool found,
                           bool ended) {
        if (!ended) add_light_of_volumes(sample, transmission);
        const SurfaceId id = m_store.id[sample];
        if (id == kNoSurface || (ended && found)) {
            if (!ended) add_environment(sample, transmission);
            return;
        }
        const SurfacePoint point = meet(sample);
        if (!found) m_channels->set_first(sample, point);
        if (!ended) add_behind(sample, point, transmission);
    }

    /// Hands layers to the channels.
    class ListChannels : public LayerVisitor {
      public:
        ListChannels(const FragmentLists& lists, const GridPool& pool,
                     const RefinedSamples& refined, const SampleVolumes& volumes,
                     ChannelLayers& channels)
            : m_lists(lists),
              m_pool(pool),
              m_refined(refined),
              m_volumes(volumes),
              m_channels(channels) {}
        void layer(std::uint32_t slot, std::uint32_t k, const Fragment& fragment, bool first,
                   bool adds, const Vec3d& transmission) override {
            const SurfacePoint* const refined = m_refined.layer_point(slot, k);
            const SurfacePoint point = refined ? *refined : point_of(fragment, m_pool);
            const std::uint32_t sample = m_lists.sample(slot);
            if (first) m_channels.set_first(sample, point);
            if (!adds) return;
            Vec3d through = transmission;
            if (!m_volumes.empty()) {
                const SampleVolume& volume = m_volumes.before_layer(sample, k);
                m_channels.add_volume(sample, volume, transmission);
                through *= Vec3d(volume.transmittance);
            }
            if (!point.grid->holdout) m_channels.add(sample, point, through);
        }

      private:
        const FragmentLists& m_lists;
        const GridPool& m_pool;
        const RefinedSamples& m_refined;
        const SampleVolumes& m_volumes;
        ChannelLayers& m_channels;
    };

    const TileStore& m_store;
    const TileSamples& m_samples;
    LayerTable& m_table;
    std::span<const Vec3f> m_background;
    const CompositeSettings& m_settings;
    ChannelLayers* m_channels;
    const RefinedSamples& m_refined;
    const SampleVolumes& m_volumes;
    SampleColors& m_colors;
    bool m_blurred;
    std::vector<std::uint8_t> m_done;  ///< [samples] 1 = has its colour; empty: none has
    SurfaceInterpolator m_surface;
    SurfaceRun m_run;
    std::vector<bool> m_listed;  ///< by sample; empty without channels or lists
};

}  // namespace

void composite_tile(const TileStore& store, const TileSamples& samples, LayerTable& table,
                    std::span<const Vec3f> background, const CompositeSettings& settings,
                    SampleColors& colors, SampleChannels* channels, const RefinedSamples& refined,
                    const SampleVolumes& volumes) {
    const std::size_t count = store.key.size();
    const bool has_channels = settings.channels && !settings.channels->empty();
    GRANITA_CHECK(!has_channels || channels);
    if (!settings.film_transparent || (has_channels && settings.channels->has_environment()))
        GRANITA_CHECK(background.size() == 1 || background.size() == count);
    std::optional<ChannelLayers> layers;
    if (has_channels) layers.emplace(*settings.channels, samples, *channels);
    colors.resize(count);
    TileComposite(store, samples, table, background, settings, layers ? &*layers : nullptr, refined,
                  volumes, colors)
        .run();
}

}  // namespace granita
