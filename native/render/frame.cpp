// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame.h"

#include <algorithm>
#include <thread>

#include "base/stage_timer.h"
#include "render/faces_of_samples.h"
#include "render/neighbour_grids.h"
#include "render/raster_bucket.h"
#include "shade/material_displacement.h"

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
    view.has_light = shading.has_light();
    view.geometries = shading.geometries();
    const float margin = filter.radius();
    view.raster_x0 = view.raster_y0 = -margin;
    view.raster_x1 = static_cast<float>(scene.options.width) + margin;
    view.raster_y1 = static_cast<float>(scene.options.height) + margin;
    return view;
}

HiderFrame make_hider_frame(Frame& frame) {
    HiderFrame out{&frame.levels.all(), frame.view.projection, &frame.statistics,
                   &frame.scene,        &frame.said(),         &frame.progress};
    const Options& options = frame.scene.options;
    const bool has_passes = options.depth_pass || !ChannelSet(options).empty();
    out.list_end = {options.opacity_threshold, has_passes ? options.pass_alpha_threshold : 0.0f};
    out.z_batch_size = options.z_batch_size;
    const unsigned threads =
        options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    const int list_memory = options.memory > 0
                                ? std::clamp(options.memory / 4, 1, options.list_memory)
                                : options.list_memory;
    out.list_bytes = (static_cast<std::uint64_t>(list_memory) << 20) / threads;
    return out;
}

Vec3f constant_background_of(const ShadingSystem& shading) {
    if (!shading.background_is_constant()) return Vec3f(0.0f);
    std::vector<Vec3f> color;
    shading.background({.directions = {Vec3f(0, 0, 1)}}, color);
    return color.at(0);
}

/// Pixels along a bucket's side.  The CPU fills, sorts and composites a bucket's samples and lists
/// while the cache still holds them: at 256 samples what is opaque takes 7 to 15 % less in buckets
/// of 16 pixels than in buckets of 64, and feathers half (docs/decisions/transparency.md).
int bucket_size(const Options& options, int samples, Executor executor) {
    constexpr std::int64_t kCachedSamples = 1 << 16;
    if (executor != Executor::Simd) return options.bucket_size;
    std::int64_t size = options.bucket_size;
    while (size > kTileSize && size * size * samples > kCachedSamples) size -= kTileSize;
    return static_cast<int>(size);
}

int rounded_down(int pixel) {
    return pixel & -kTileSize;
}

/// The film merges what CPU buckets contribute to each other's pixels; raster buckets filter by
/// themselves.  Where tiles take what samples they need, that is decided by whole tiles, lest it
/// depend on the crop.
BucketLayout make_layout(const Options& options, const Film& film, const SampleLevels& levels,
                         Executor executor, int around) {
    const int size = bucket_size(options, levels.fewest().samples(), executor);
    const Rect& pixels = film.sample_pixels();
    if (executor == Executor::Raster)
        return BucketLayout(options.crop, size, options.crop.x0 - pixels.x0, around);
    if (levels.count() == 1) return BucketLayout(pixels, size, 0, around);
    return BucketLayout(
        {rounded_down(pixels.x0), rounded_down(pixels.y0), rounded_down(pixels.x1 + kTileSize - 1),
         rounded_down(pixels.y1 + kTileSize - 1)},
        size, 0, around);
}

std::optional<SceneChanges> changes_since(const PersistentVisibility* before, const Scene& scene) {
    if (!before) return std::nullopt;
    return SceneChanges(before->scene(), scene);
}

PersistentShading shading_after(PersistentShading shading, const PersistentVisibility* before,
                                const std::optional<SceneChanges>& changes, const Scene& scene) {
    if (!before) return shading;
    shading.grids = before->shaded_grids(*changes);
    if (before->displaces_alike(scene, *changes)) shading.offsets = before->offsets();
    return shading;
}

PixelFilter filter_of(const Scene& scene) {
    return PixelFilter(scene.options.pixel_filter, scene.options.filter_width);
}

/// What is kept of the frame.  Not what takes its samples by noise, nor what lies in a device.
std::unique_ptr<PersistentVisibility> make_visibility(
    Frame& frame, const std::shared_ptr<const Scene>& scene,
    const std::shared_ptr<Statistics>& statistics) {
    if (frame.choice.gl || frame.levels.count() > 1) return nullptr;
    if (frame.before) {
        if (frame.before->serves(*scene, *frame.changes, frame.shading,
                                 frame.film.sample_pixels())) {
            frame.sees_anew = false;
            frame.before->renew(scene, *frame.changes, frame.shading);
            frame.before->say(*frame.shading.geometries(), frame.report);
            return std::move(frame.before);
        }
        frame.before->forget_samples();
    }
    return std::make_unique<PersistentVisibility>(scene, frame.shared_view, statistics,
                                                  frame.shading, frame.film.sample_pixels(),
                                                  frame.layout.count(), frame.shared_levels);
}

}  // namespace

Frame::Frame(const std::shared_ptr<const Scene>& frame_scene,
             const std::shared_ptr<Statistics>& frame_statistics, Report& frame_report,
             const Progress& frame_progress, ExecutorChoice frame_choice, PersistentPicture kept)
    : scene(*frame_scene),
      statistics(*frame_statistics),
      report(frame_report),
      progress(frame_progress),
      before(std::move(kept.visibility)),
      changes(changes_since(before.get(), scene)),
      shading(scene, statistics, report, progress, frame_choice.executor != Executor::Raster,
              shading_after(kept.shading, before.get(), changes, scene)),
      shared_view(std::make_shared<View>(make_view(scene, statistics, shading, filter_of(scene)))),
      view(*shared_view),
      shared_levels(std::make_shared<const SampleLevels>(
          view, filter_of(scene), frame_choice.executor != Executor::Raster, report)),
      levels(*shared_levels),
      constant_background(constant_background_of(shading)),
      has_catchers(scene.has_shadow_catchers()),
      choice(std::move(frame_choice)),
      raster(choice.executor == Executor::Raster
                 ? std::make_unique<RasterHider>(
                       *choice.gl, make_raster_frame(scene, view.projection, levels.all(),
                                                     statistics, report, choice.gl->info()))
                 : nullptr),
      film(scene.options),
      layout(make_layout(scene.options, film, levels, choice.executor,
                         shading.shares_light() ? neighbour_margin(scene.options) : 0)),
      visibility(kept.is_kept ? make_visibility(*this, frame_scene, frame_statistics) : nullptr),
      hider(make_hider_frame(*this)),
      geometry(view, layout, report, said(), levels.count() > 1 || shading.shares_light()) {
    // The raster executor's samples are its device's.
    if (choice.executor != Executor::Raster)
        shared_view->sampled_faces = std::make_shared<const FacesOfSamples>(
            view, shared_levels, shading, std::move(kept.shading.rays), progress);
}

std::unique_ptr<PersistentVisibility> Frame::take_visibility() {
    if (!visibility) return nullptr;
    visibility->end_picture();
    // It is to be said again.
    if (shading.displacement() && shading.displacement()->has_said()) return nullptr;
    if (sees_anew) {
        report.add(visibility->said());
        std::vector<std::size_t> opened;
        geometry.for_each_opened([&](std::uint32_t instance) {
            opened.push_back(static_cast<std::size_t>(scene.instances[instance].geometry));
        });
        visibility->set_opened(std::move(opened));
    }
    return visibility->is_whole() ? std::move(visibility) : nullptr;
}

}  // namespace granita
