// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/raster_bucket.h"

#include "film/filter.h"
#include "render/visit_geometry.h"

namespace granita {
namespace {

/// Depth is not filtered: the sample nearest to the pixel's centre, as Film does it.
std::vector<float> center_depths(const RasterSurfaces& surfaces, const Rect& pixels,
                                 const Projection& projection) {
    const int lattice = surfaces.lattice, row = surfaces.pixels.width() * lattice;
    std::vector<float> depths;
    for (int y = pixels.y0; y < pixels.y1; ++y)
        for (int x = pixels.x0; x < pixels.x1; ++x) {
            const int sx = (x - surfaces.pixels.x0) * lattice + (lattice - 1) / 2;
            const int sy = (y - surfaces.pixels.y0) * lattice + (lattice - 1) / 2;
            const auto sample = static_cast<std::size_t>(sy) * static_cast<std::size_t>(row) +
                                static_cast<std::size_t>(sx);
            depths.push_back(surfaces.surface[sample].grid < 0
                                 ? Film::kNoDepth
                                 : projection.depth_from_key(surfaces.key[sample]));
        }
    return depths;
}

}  // namespace

RasterFrame make_raster_frame(const Scene& scene, const Projection& projection,
                              const SampleTable& table, const Vec3f& background,
                              Statistics& statistics) {
    const PixelFilter filter(scene.options.pixel_filter, scene.options.filter_width);
    const int lattice = table.lattice();
    RasterFrame frame;
    frame.projection = projection;
    frame.filter = make_raster_filter(
        lattice, filter.radius(), [&](double d) { return filter.evaluate(static_cast<float>(d)); });
    if (!scene.options.film_transparent) frame.background = Vec4f(background, 1.0f);
    frame.statistics = &statistics;
    return frame;
}

Tile raster_bucket(Frame& frame, int bucket) {
    const Rect pixels = frame.layout.pixels(bucket);
    std::vector<std::shared_ptr<SharedGrid>> grids;
    visit_geometry(
        frame, bucket, [](const RasterBounds&) { return false; },
        [&](std::shared_ptr<SharedGrid> grid) { grids.push_back(std::move(grid)); });
    std::vector<const Grid*> plain;
    for (const auto& grid : grids) plain.push_back(&grid->grid());

    std::unique_ptr<RasterBucket> device_bucket;
    std::vector<std::uint64_t> visible;
    {
        const StageTimer timer(frame.statistics, Stage::Hide);
        device_bucket = frame.raster->open(pixels, plain);
        visible = device_bucket->count_visible();
    }
    for (std::size_t i = 0; i < grids.size(); ++i) {
        frame.progress.check();
        if (visible[i] > 0) grids[i]->ensure_radiance(frame.shading);
    }
    const StageTimer timer(frame.statistics, Stage::Hide);
    Tile tile;
    tile.rect = pixels;
    tile.combined = device_bucket->render().combined;
    if (frame.scene.options.depth_pass)
        tile.depth = center_depths(device_bucket->surfaces(), pixels, frame.view.projection);
    return tile;
}

}  // namespace granita
