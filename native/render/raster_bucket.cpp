// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/raster_bucket.h"

#include <cmath>

#include "base/stage_timer.h"
#include "film/filter.h"
#include "hider/raster/raster_samples.h"
#include "render/background.h"
#include "render/shade_seen.h"
#include "render/visit_geometry.h"

namespace granita {
namespace {

RasterBackground background(const Frame& frame, const Rect& pixels) {
    RasterBackground out;
    if (frame.scene.options.film_transparent) return out;
    out.constant = Vec4f(frame.constant_background, 1.0f);
    if (frame.shading.background_is_constant()) return out;
    const Camera& camera = frame.scene.camera;
    const std::vector<RasterPass>& passes = frame.raster->frame().passes;
    const bool varies =
        passes.size() > 1 && (camera.world_from_camera.size() > 1 || camera.projection.has_lens());
    out.passes = varies ? static_cast<int>(passes.size()) : 1;
    out.pixels = frame.raster->sample_pixels(pixels);
    for (int p = 0; p < out.passes; ++p) {
        frame.progress.check();
        const RasterPass& pass = passes[p];
        for (const Vec3f& color : corner_background(camera, frame.shading, out.pixels, pass))
            out.corners.emplace_back(color, 1.0f);
    }
    return out;
}

/// What the bucket met, for the statistics.
void count_needs(Frame& frame, const std::vector<const GridSweep*>& sweeps) {
    bool moving = frame.view.projection.has_lens() && !sweeps.empty(), transparent = false;
    for (const GridSweep* sweep : sweeps) {
        moving |= sweep->grid().motion;
        transparent |= sweep->grid().opacity_varies;
    }
    frame.statistics.add(Counter::BucketsMoving, moving);
    frame.statistics.add(Counter::BucketsTransparent, transparent);
}

}  // namespace

RasterFrame make_raster_frame(const Scene& scene, const Projection& projection,
                              const SampleTable& table, Statistics& statistics, Report& report,
                              const gl::ContextInfo& device) {
    const PixelFilter filter(scene.options.pixel_filter, scene.options.filter_width);
    RasterFrame frame;
    frame.projection = projection;
    const auto factor = [&](double d) { return filter.evaluate(static_cast<float>(d)); };
    if (table.sampling() == Sampling::Regular) {
        frame.filter = make_raster_filter(table.lattice(), filter.radius(), factor);
        frame.passes = raster_passes(table, table.needs(), projection);
    } else {
        frame.filter = make_gathering_filter(sample_lattice(table.samples()), filter.radius(),
                                             filter.is_box(), factor);
        frame.table = &table;
        frame.needs = table.needs();
        frame.lifespans = scene.has_lifespans();
    }
    frame.opacity_threshold = scene.options.opacity_threshold;
    frame.film_transparent = scene.options.film_transparent;
    frame.z_batch_size = scene.options.z_batch_size;
    // A software driver peels at the price of shading (docs/decisions/gl.md).
    frame.cull_saturated = !device.software;
    frame.statistics = &statistics;
    frame.scene = &scene;
    frame.report = &report;
    return frame;
}

Tile raster_bucket(Frame& frame, int bucket) {
    const Rect pixels = frame.layout.pixels(bucket);
    std::vector<std::shared_ptr<SharedGrid>> grids;
    visit_geometry(
        frame, bucket, frame.layout.reach(bucket), [](const TimeSlab&) { return false; },
        [&](std::shared_ptr<SharedGrid> grid) {
            if (frame.shading.opacity_varies(grid->grid().material))
                grid->ensure_opacity(frame.shading, frame.statistics);
            grids.push_back(std::move(grid));
        });
    std::vector<const GridSweep*> sweeps;
    sweeps.reserve(grids.size());
    for (const auto& grid : grids)
        sweeps.push_back(&grid->sweep(frame.view.projection, frame.lens()));
    count_needs(frame, sweeps);

    std::unique_ptr<RasterBucket> device_bucket;
    std::vector<bool> seen;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        device_bucket = frame.raster->open(pixels, std::span<const GridSweep* const>(sweeps));
        seen = device_bucket->find_seen();
    }
    shade_grids(frame, bucket, grids, seen);
    RasterBackground behind;
    {
        const StageTimer timer(frame.statistics, Stage::Shade);
        behind = background(frame, pixels);
    }
    const StageTimer timer(frame.statistics, Stage::Hide);
    Tile tile;
    tile.rect = pixels;
    tile.combined = device_bucket->render(behind).combined;
    if (frame.scene.options.depth_pass) {
        tile.depth = device_bucket->center_keys();
        for (float& depth : tile.depth)
            depth =
                std::isinf(depth) ? Film::kNoDepth : frame.view.projection.depth_from_key(depth);
    }
    return tile;
}

}  // namespace granita
