// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/composite.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "hider/surface_interpolator.h"

namespace granita {
namespace {

/// Order of Fragment lists: sample, nearest first, ties by `before`.
void sort_fragments(std::vector<Fragment>& fragments, const GridPool& pool) {
    std::sort(fragments.begin(), fragments.end(), [&](const Fragment& a, const Fragment& b) {
        if (a.sample != b.sample) return a.sample < b.sample;
        if (a.key != b.key) return a.key > b.key;
        return a.id != b.id && pool.before(a.id, b.id);
    });
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

    /// True when the threshold is reached.
    bool add(const SurfacePoint& at, bool opaque, double threshold) {
        const Grid& grid = *at.grid;
        const Vec3d a = opaque ? Vec3d(1.0) : clamp_opacity(at(grid.opacity));
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

}  // namespace

std::vector<SampleColor> composite_tile(TileStore& store, const TileSamples& samples,
                                        const GridPool& pool, std::span<const Vec3f> background,
                                        const CompositeSettings& settings) {
    const std::size_t count = store.key.size();
    if (!settings.film_transparent)
        GRANITA_CHECK(background.size() == 1 || background.size() == count);
    sort_fragments(store.fragments, pool);
    SurfaceInterpolator surface(settings.projection, store.tile, samples, pool);
    std::vector<SampleColor> colors(count);
    auto next = store.fragments.begin();
    for (std::uint32_t i = 0; i < count; ++i) {
        Layers layers;
        bool ended = false;
        float nearest = store.key[i];
        if (next != store.fragments.end() && next->sample == i)
            nearest = std::max(nearest, next->key);
        for (; next != store.fragments.end() && next->sample == i; ++next)
            if (!ended)
                ended = layers.add(surface.locate(i, next->id), false, settings.opacity_threshold);
        if (!ended && store.id[i] != kNoSurface)
            layers.add(surface.locate(i, store.id[i]), true, settings.opacity_threshold);

        SampleColor& out = colors[i];
        Vec3d color = layers.color;
        double alpha = layers.alpha;
        if (!settings.film_transparent) {
            color += layers.transmission * Vec3d(background[background.size() == 1 ? 0 : i]);
            alpha = 1.0 - layers.cut;
        }
        out.color = Vec3f(color);
        out.alpha = static_cast<float>(alpha);
        out.depth = nearest > -std::numeric_limits<float>::infinity()
                        ? settings.projection.depth_from_key(nearest)
                        : std::numeric_limits<float>::infinity();
    }
    return colors;
}

}  // namespace granita
