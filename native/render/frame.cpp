// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame.h"

#include "render/choose_executor.h"

namespace granita {
namespace {

View make_view(const Scene& scene, Statistics& statistics, const ShadingSystem& shading,
               const PixelFilter& filter) {
    View view;
    view.scene = &scene;
    view.statistics = &statistics;
    view.projection = scene.camera.projection;
    view.requests = shading.requests();
    view.displacement = shading.displacement();
    const float apron = filter.radius();
    view.raster_x0 = view.raster_y0 = -apron;
    view.raster_x1 = static_cast<float>(scene.options.width) + apron;
    view.raster_y1 = static_cast<float>(scene.options.height) + apron;
    return view;
}

}  // namespace

Frame::Frame(const Scene& frame_scene, Statistics& frame_statistics, Report& frame_report,
             const Progress& frame_progress)
    : scene(frame_scene),
      statistics(frame_statistics),
      report(frame_report),
      progress(frame_progress),
      shading(scene, statistics, report, progress),
      view(make_view(scene, statistics, shading,
                     PixelFilter(scene.options.pixel_filter, scene.options.filter_width))),
      table(scene.options, scene.camera),
      hider{&table, view.projection, &statistics, &scene, &report},
      film(scene.options),
      layout(film.sample_pixels(), scene.options.bucket_size),
      geometry(view, layout, report),
      executor(choose_executor(scene.options)) {
    if (shading.background_is_constant()) {
        std::vector<Vec3f> color;
        shading.background({Vec3f(0, 0, 1)}, 0.0f, color);
        constant_background = color.at(0);
    }
}

}  // namespace granita
