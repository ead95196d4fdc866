// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/composite.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>

#include "base/check.h"
#include "hider/channel_layers.h"
#include "hider/layer_cache.h"
#include "hider/surface_interpolator.h"

namespace granita {
namespace {

Vec3d clamp_opacity(const LayerCache::Row& row) {
    Vec3d out;
    for (int i = 0; i < 3; ++i)
        out[i] = row[i] > 0.0f ? std::min(row[i], 1.0f) : 0.0f;  // not a number: clear
    return out;
}

double mean(const Vec3d& v) {
    return (v.x + v.y + v.z) / 3.0;
}

/// The layers of one sample so far.
struct Layers {
    Vec3d color{0.0}, opacity{0.0}, transmission{1.0};
    double alpha = 0.0, cut = 0.0;  ///< covered by surfaces; by holdouts

    /// `a`: opacity; `radiance` is 0 where it is not known.  True when the threshold is reached.
    bool add(bool holdout, const Vec3d& radiance, const Vec3d& a, double threshold) {
        if (!holdout) color += transmission * radiance;
        // T -= a T keeps what float's 1 - a loses: 1e6 layers of 1e-6 (hider-research 4.4, case
        // 36).
        const Vec3d covered = a * transmission;
        opacity += covered;
        transmission -= covered;
        (holdout ? cut : alpha) += mean(covered);
        return threshold < 1.0 && std::min({opacity.x, opacity.y, opacity.z}) >= threshold;
    }
};

/// TileComposite::opaque_alone for a run of samples at once.
void set_opaque(const TileStore& store, const CompositeSettings& settings, std::uint32_t first,
                const SurfaceRun& run, SampleColors& colors) {
    const auto copy = [&](const float* from, std::vector<float>& to) {
        for (int i = 0; i < SurfaceRun::kCount; ++i) to[first + i] = from[i] + 0.0f;
    };
    copy(run.color[0], colors.red);
    copy(run.color[1], colors.green);
    copy(run.color[2], colors.blue);
    for (int i = 0; i < SurfaceRun::kCount; ++i) colors.alpha[first + i] = 1.0f;
    if (!settings.depth) return;
    for (int i = 0; i < SurfaceRun::kCount; ++i)
        colors.depth[first + i] = settings.projection.depth_from_key(store.key[first + i]);
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

/// Bit i: sample first + i has fragments.
std::uint32_t with_lists(const SampleLists& lists, std::uint32_t first) {
    std::uint32_t bits = 0;
    if (lists.begin.empty()) return bits;
    for (int i = 0; i < SurfaceRun::kCount; ++i)
        bits |= std::uint32_t{lists.begin[first + i] != lists.begin[first + i + 1]} << i;
    return bits;
}

constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// Composites the samples of one tile, in order.
class TileComposite {
  public:
    TileComposite(const TileStore& store, const GridPool& pool, std::span<const Vec3f> background,
                  const CompositeSettings& settings, ChannelLayers* channels)
        : m_store(store),
          m_background(background),
          m_settings(settings),
          m_channels(channels),
          m_fragments(pool) {}

    /// A sample that sees nothing, before a constant background and without channels.
    SampleColor empty() {
        m_layers = {};
        m_first_key = kNothing;
        return finish(0);
    }

    /// The sample's nearest opaque surface.
    struct Opaque {
        bool holdout = false;
        Vec3f radiance{0.0f};  ///< 0 where it is not known
        SurfacePoint point;    ///< only where there are channels
    };

    /// `opaque`: read where the sample has one.
    SampleColor next(std::uint32_t sample, const Opaque& opaque) {
        const std::span<const Fragment> list = m_store.lists.of(sample);
        if (list.empty() && m_store.id[sample] != kNoSurface && !opaque.holdout)
            return opaque_alone(sample, opaque);
        m_layers = {};
        m_first_key = kNothing;
        bool ended = false;
        for (const Fragment& fragment : list) {
            if (is_complete(ended)) break;
            const LayerCache::Micropolygon& at = m_fragments.load(fragment.id);
            const LayerCache::Row row = LayerCache::interpolate(at, fragment);
            const Layer layer{at.grid->holdout, Vec3d(row[3], row[4], row[5]), clamp_opacity(row),
                              fragment.key};
            ended = add(sample, layer, ended, [&] { return LayerCache::point(at, fragment); });
        }
        if (m_store.id[sample] != kNoSurface && !is_complete(ended)) {
            const Layer layer{opaque.holdout, opaque.radiance, Vec3d(1.0), m_store.key[sample]};
            add(sample, layer, ended, [&] { return opaque.point; });
        }
        return finish(sample);
    }

  private:
    /// What the layers would give, without the sums: most samples of most pictures.
    SampleColor opaque_alone(std::uint32_t sample, const Opaque& opaque) {
        if (m_channels) {
            m_channels->set_first(sample, opaque.point);
            m_channels->add(sample, opaque.point, Vec3d(1.0));
        }
        return {opaque.radiance + Vec3f(0.0f), 1.0f,
                m_settings.projection.depth_from_key(m_store.key[sample])};
    }

    /// A list that has ended is followed only to the layer that stands for the sample.
    bool is_complete(bool ended) const { return ended && m_first_key != kNothing; }

    struct Layer {
        bool holdout;
        Vec3d radiance, opacity;
        float key;
    };

    /// `point`: makes the layer's SurfacePoint where channels want it.  True when the list has
    /// ended.
    template <class Point>
    bool add(std::uint32_t sample, const Layer& layer, bool ended, Point point) {
        if (m_first_key == kNothing && mean(layer.opacity) >= m_settings.end.pass_alpha_threshold) {
            m_first_key = layer.key;
            if (m_channels) m_channels->set_first(sample, point());
        }
        if (ended) return true;
        if (m_channels && !layer.holdout) m_channels->add(sample, point(), m_layers.transmission);
        return m_layers.add(layer.holdout, layer.radiance, layer.opacity,
                            m_settings.end.opacity_threshold);
    }

    SampleColor finish(std::uint32_t sample) {
        Vec3d color = m_layers.color;
        double alpha = m_layers.alpha;
        if (!m_background.empty()) {
            const Vec3f& behind = m_background[m_background.size() == 1 ? 0 : sample];
            if (m_channels) m_channels->add_environment(sample, behind, m_layers.transmission);
            if (!m_settings.film_transparent) color += m_layers.transmission * Vec3d(behind);
        }
        if (!m_settings.film_transparent) alpha = 1.0 - m_layers.cut;
        return {Vec3f(color), static_cast<float>(alpha),
                m_first_key > kNothing ? m_settings.projection.depth_from_key(m_first_key)
                                       : std::numeric_limits<float>::infinity()};
    }

    const TileStore& m_store;
    std::span<const Vec3f> m_background;
    const CompositeSettings& m_settings;
    ChannelLayers* m_channels;
    LayerCache m_fragments;
    Layers m_layers;
    float m_first_key = kNothing;
};

}  // namespace

void composite_tile(const TileStore& store, const TileSamples& samples, const GridPool& pool,
                    std::span<const Vec3f> background, const CompositeSettings& settings,
                    SampleColors& colors, SampleChannels* channels) {
    const std::size_t count = store.key.size();
    const bool has_channels = settings.channels && !settings.channels->empty();
    GRANITA_CHECK(!has_channels || channels);
    if (!settings.film_transparent || (has_channels && settings.channels->has_environment()))
        GRANITA_CHECK(background.size() == 1 || background.size() == count);
    SurfaceInterpolator surface(settings.projection, store.tile, samples, pool);
    std::optional<ChannelLayers> layers;
    if (has_channels) layers.emplace(*settings.channels, samples, *channels);
    TileComposite composite(store, pool, background, settings, layers ? &*layers : nullptr);
    colors.resize(count);
    constexpr std::uint32_t kRun = SurfaceRun::kCount, kAll = (1u << kRun) - 1u;
    SurfaceRun run;
    const bool constant = !has_channels && background.size() <= 1;
    const SampleColor empty = constant ? composite.empty() : SampleColor{};
    for (std::uint32_t first = 0; first < count; first += kRun) {
        surface.locate_run(first, &store.id[first], has_channels, run);
        const std::uint32_t lists = with_lists(store.lists, first), known = run.plain & run.colored;
        // Most samples of most pictures: one opaque surface and nothing else.
        std::uint32_t done = has_channels ? 0u : known & ~lists;
        if (done != 0) set_opaque(store, settings, first, run, colors);
        const std::uint32_t something = run.seen | lists;
        if (constant && something != kAll) {
            set_empty(first, something, empty, colors);
            done |= kAll & ~something;
        }
        for (std::uint32_t rest = kAll & ~done; rest != 0; rest &= rest - 1) {
            const int i = std::countr_zero(rest);
            const std::uint32_t sample = first + static_cast<std::uint32_t>(i);
            const SurfaceId id = store.id[sample];
            TileComposite::Opaque opaque;
            if (id != kNoSurface && !has_channels && (known >> i & 1u)) {
                opaque.radiance = {run.color[0][i], run.color[1][i], run.color[2][i]};
            } else if (id != kNoSurface) {
                opaque.point = has_channels && (run.plain >> i & 1u) ? run.point(i)
                                                                     : surface.locate(sample, id);
                const Grid& grid = *opaque.point.grid;
                opaque.holdout = grid.holdout;
                if (!grid.radiance.empty()) opaque.radiance = opaque.point(grid.radiance);
            }
            colors.set(sample, composite.next(sample, opaque));
        }
    }
}

}  // namespace granita
