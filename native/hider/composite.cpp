// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/composite.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>

#include "base/check.h"
#include "hider/channel_layers.h"
#include "hider/surface_interpolator.h"

namespace granita {
namespace {

/// Order of Fragment lists: sample, nearest first, ties by `before`.  Fragments come in order of
/// grids; they are counted into samples, whose lists are short.
void sort_fragments(std::vector<Fragment>& fragments, std::size_t samples, const GridPool& pool) {
    if (fragments.empty()) return;
    std::vector<std::uint32_t> begin(samples + 1, 0);
    for (const Fragment& fragment : fragments) ++begin[fragment.sample + 1];
    for (std::size_t i = 0; i < samples; ++i) begin[i + 1] += begin[i];
    std::vector<Fragment> sorted(fragments.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (const Fragment& fragment : fragments) sorted[next[fragment.sample]++] = fragment;
    for (std::size_t i = 0; i < samples; ++i)
        std::sort(sorted.begin() + begin[i], sorted.begin() + begin[i + 1],
                  [&](const Fragment& a, const Fragment& b) {
                      if (a.key != b.key) return a.key > b.key;
                      return a.id != b.id && pool.before(a.id, b.id);
                  });
    fragments = std::move(sorted);
}

Vec3d clamp_opacity(const Vec3f& a) {
    Vec3d out;
    for (int i = 0; i < 3; ++i) out[i] = a[i] > 0.0f ? std::min(a[i], 1.0f) : 0.0f;  // NaN: clear
    return out;
}

double mean(const Vec3d& v) {
    return (v.x + v.y + v.z) / 3.0;
}

/// The layers of one sample so far.
struct Layers {
    Vec3d color{0.0}, opacity{0.0}, transmission{1.0};
    double alpha = 0.0, cut = 0.0;  ///< covered by surfaces; by holdouts

    /// `a`: opacity.  True when the threshold is reached.
    bool add(const SurfacePoint& at, const Vec3d& a, double threshold) {
        const Grid& grid = *at.grid;
        if (!grid.holdout && !grid.radiance.empty())
            color += transmission * Vec3d(at(grid.radiance));
        // T -= a T keeps what float's 1 - a loses: 1e6 layers of 1e-6 (hider-research 4.4, case
        // 36).
        const Vec3d covered = a * transmission;
        opacity += covered;
        transmission -= covered;
        (grid.holdout ? cut : alpha) += mean(covered);
        return threshold < 1.0 && std::min({opacity.x, opacity.y, opacity.z}) >= threshold;
    }
};

/// TileComposite::opaque_alone for a run of samples at once.
void set_opaque(const TileStore& store, const Projection& projection, std::uint32_t first,
                const SurfaceRun& run, SampleColors& colors) {
    const auto copy = [&](const float* from, std::vector<float>& to) {
        for (int i = 0; i < SurfaceRun::kCount; ++i) to[first + i] = from[i] + 0.0f;
    };
    copy(run.color[0], colors.red);
    copy(run.color[1], colors.green);
    copy(run.color[2], colors.blue);
    for (int i = 0; i < SurfaceRun::kCount; ++i) colors.alpha[first + i] = 1.0f;
    for (int i = 0; i < SurfaceRun::kCount; ++i)
        colors.depth[first + i] = projection.depth_from_key(store.key[first + i]);
}

/// The samples of a run that see nothing.
void set_empty(std::uint32_t first, std::uint32_t seen, const SampleColor& empty,
               SampleColors& colors) {
    const float values[] = {empty.color.x, empty.color.y, empty.color.z, empty.alpha, empty.depth};
    std::vector<float>* const planes[] = {&colors.red, &colors.green, &colors.blue, &colors.alpha,
                                          &colors.depth};
    for (int k = 0; k < 5; ++k) {
        float* const to = planes[k]->data() + first;
        for (int i = 0; i < SurfaceRun::kCount; ++i) to[i] = seen >> i & 1u ? to[i] : values[k];
    }
}

constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// Composites the samples of one tile, in order.
class TileComposite {
  public:
    TileComposite(const TileStore& store, SurfaceInterpolator& surface,
                  std::span<const Vec3f> background, const CompositeSettings& settings,
                  ChannelLayers* channels)
        : m_store(store),
          m_surface(surface),
          m_background(background),
          m_settings(settings),
          m_channels(channels),
          m_next(store.fragments.begin()) {}

    /// Whether any of the samples before `end` has fragments.
    bool has_fragments_before(std::uint32_t end) const {
        return m_next != m_store.fragments.end() && m_next->sample < end;
    }

    /// A sample that sees nothing, before a constant background and without channels.
    SampleColor empty() {
        m_layers = {};
        m_first_key = kNothing;
        return finish(0);
    }

    /// `opaque`: where the sample meets its nearest opaque surface, if it has one.
    SampleColor next(std::uint32_t sample, const SurfacePoint& opaque) {
        if (!has_fragments_before(sample + 1) && m_store.id[sample] != kNoSurface &&
            !opaque.grid->holdout && !opaque.grid->radiance.empty())
            return opaque_alone(sample, opaque);
        m_layers = {};
        m_first_key = kNothing;
        bool ended = false;
        for (; m_next != m_store.fragments.end() && m_next->sample == sample; ++m_next) {
            if (is_complete(ended)) continue;
            const SurfacePoint at = m_surface.locate(sample, m_next->id);
            ended = add(sample, at, m_next->key, clamp_opacity(at(at.grid->opacity)), ended);
        }
        if (m_store.id[sample] != kNoSurface && !is_complete(ended))
            add(sample, opaque, m_store.key[sample], Vec3d(1.0), ended);
        return finish(sample);
    }

  private:
    /// What the layers would give, without the sums: most samples of most pictures.
    SampleColor opaque_alone(std::uint32_t sample, const SurfacePoint& at) {
        if (m_channels) {
            m_channels->set_first(sample, at);
            m_channels->add(sample, at, Vec3d(1.0));
        }
        return {at(at.grid->radiance) + Vec3f(0.0f), 1.0f,
                m_settings.projection.depth_from_key(m_store.key[sample])};
    }

    /// A list that has ended is followed only to the layer that stands for the sample.
    bool is_complete(bool ended) const { return ended && m_first_key != kNothing; }

    /// `a`: opacity.  True when the list has ended.
    bool add(std::uint32_t sample, const SurfacePoint& at, float key, const Vec3d& a, bool ended) {
        if (m_first_key == kNothing && mean(a) >= m_settings.pass_alpha_threshold) {
            m_first_key = key;
            if (m_channels) m_channels->set_first(sample, at);
        }
        if (ended) return true;
        if (m_channels && !at.grid->holdout) m_channels->add(sample, at, m_layers.transmission);
        return m_layers.add(at, a, m_settings.opacity_threshold);
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
    SurfaceInterpolator& m_surface;
    std::span<const Vec3f> m_background;
    const CompositeSettings& m_settings;
    ChannelLayers* m_channels;
    std::vector<Fragment>::const_iterator m_next;
    Layers m_layers;
    float m_first_key = kNothing;
};

}  // namespace

void composite_tile(TileStore& store, const TileSamples& samples, const GridPool& pool,
                    std::span<const Vec3f> background, const CompositeSettings& settings,
                    SampleColors& colors, SampleChannels* channels) {
    const std::size_t count = store.key.size();
    const bool has_channels = settings.channels && !settings.channels->empty();
    GRANITA_CHECK(!has_channels || channels);
    if (!settings.film_transparent || (has_channels && settings.channels->has_environment()))
        GRANITA_CHECK(background.size() == 1 || background.size() == count);
    sort_fragments(store.fragments, count, pool);
    SurfaceInterpolator surface(settings.projection, store.tile, samples, pool);
    std::optional<ChannelLayers> layers;
    if (has_channels) layers.emplace(*settings.channels, samples, *channels);
    TileComposite composite(store, surface, background, settings, layers ? &*layers : nullptr);
    colors.resize(count);
    constexpr std::uint32_t kRun = SurfaceRun::kCount, kAll = (1u << kRun) - 1u;
    SurfaceRun run;
    const bool constant = !has_channels && background.size() <= 1;
    const SampleColor empty = constant ? composite.empty() : SampleColor{};
    for (std::uint32_t first = 0; first < count; first += kRun) {
        const bool points = has_channels || composite.has_fragments_before(first + kRun);
        surface.locate_run(first, &store.id[first], points, run);
        // Most samples of most pictures: one opaque surface and nothing else.
        std::uint32_t done = points ? 0u : run.plain & run.colored;
        if (done != 0) set_opaque(store, settings.projection, first, run, colors);
        if (constant && !points && run.seen != kAll) {
            set_empty(first, run.seen, empty, colors);
            done |= kAll & ~run.seen;
        }
        for (std::uint32_t rest = kAll & ~done; rest != 0; rest &= rest - 1) {
            const int i = std::countr_zero(rest);
            const std::uint32_t sample = first + static_cast<std::uint32_t>(i);
            SurfacePoint opaque;
            if (store.id[sample] != kNoSurface)
                opaque = points && (run.plain >> i & 1u) ? run.point(i)
                                                         : surface.locate(sample, store.id[sample]);
            colors.set(sample, composite.next(sample, opaque));
        }
    }
}

}  // namespace granita
