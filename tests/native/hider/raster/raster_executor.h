// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a Shot by the raster executor, which has no stores of samples.
#pragma once

#include "base/error.h"
#include "hider/compute/compute_executor.h"
#include "hider/raster/raster_hider.h"
#include "hider/raster/raster_samples.h"

namespace granita::test {

inline std::unique_ptr<Hider> raster_executor(const HiderFrame&, const Rect&, const Rect&) {
    throw InternalError("the raster executor keeps no samples");
}

inline RasterFrame raster_frame(const Shot& shot, const SampleTable& table) {
    RasterFrame frame;
    frame.projection = shot.camera.projection;
    frame.opacity_threshold = shot.composite.end.opacity_threshold;
    frame.film_transparent = shot.composite.film_transparent;
    SampleNeeds needs{false, shot.camera.projection.has_lens()};
    for (const Grid& grid : shot.grids) {
        needs.time |= grid.motion;
        frame.lifespans |= !grid.lifespan.is_whole();
    }
    const auto box = [](double d) { return std::fabs(d) <= 0.5 ? 1.0 : 0.0; };
    if (table.sampling() != Sampling::Regular) {
        frame.filter = make_gathering_filter(sample_lattice(table.samples()), 0.5, true, box);
        frame.table = &table;
        frame.needs = needs;
        return frame;
    }
    frame.filter = make_raster_filter(table.lattice(), 0.5, box);
    frame.passes = raster_passes(table, {true, true}, frame.projection);
    return frame;
}

inline Picture raster_picture(Shot& shot) {
    const SampleTable table(shot.options, shot.camera);
    RasterFrame frame = raster_frame(shot, table);
    frame.statistics = &shot.statistics;
    std::vector<const Grid*> grids;
    for (const Grid& grid : shot.grids) grids.push_back(&grid);
    Picture out;
    out.pixels = {shot.tiles.x0 * 16, shot.tiles.y0 * 16, shot.tiles.x1 * 16, shot.tiles.y1 * 16};
    RasterHider hider(compute_thread(), frame);
    RasterBackground background;
    if (!frame.film_transparent) background.constant = Vec4f(shot.background, 1.0f);
    out.combined = hider.open(out.pixels, grids)->render(background).combined;
    return out;
}

/// Layers of opacity 1/2 that all samples of a pixel have met, -1 where they differ.  Of one tile.
inline std::vector<int> raster_layers(Shot& shot) {
    std::vector<int> layers;
    const auto samples = static_cast<std::size_t>(SampleTable(shot.options, shot.camera).samples());
    for (const Vec4f& pixel : raster_picture(shot).combined) {
        int n = 0;
        float through = 1.0f;
        while (n < 20 && 1.0f - through < pixel.w) through *= 0.5f, ++n;
        layers.insert(layers.end(), samples, 1.0f - through == pixel.w ? n : -1);
    }
    return layers;
}

}  // namespace granita::test
