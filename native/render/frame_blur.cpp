// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_blur.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "dice/knots.h"
#include "dice/open_instance.h"

namespace granita {
namespace {

/// What appears or vanishes is off by at most half a pass: .02, as the ripple of longest_step().
constexpr int kLifespanPasses = 25;
/// Instances that are looked at in a piece of a loop.
constexpr std::size_t kGrain = 256;

/// What an instance's motion is measured at: the corners of its box where all of it moves as one,
/// which bound the motion of what is inside, else all points.
std::vector<Vec3d> points_at(const View& view, const Instance& instance, const KnotTime& time) {
    const auto geometry = static_cast<std::size_t>(instance.geometry);
    const GeometryData& data = view.scene->geometries[geometry];
    std::vector<Vec3d> points;
    if (data.knots == 1) {
        const Bounds3f box = view.geometries->boxes(*view.scene, geometry)->at(0);
        for (int corner = 0; corner < 8; ++corner)
            points.emplace_back(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                corner & 4 ? box.hi.z : box.lo.z);
        return points;
    }
    const std::size_t count = data.vertex_count();
    for (std::size_t v = 0; v < count; ++v) {
        Vec3d p(data.points[time.knot * count + v]);
        if (time.fraction > 0.0)
            p += time.fraction * (Vec3d(data.points[(time.knot + 1) * count + v]) - p);
        points.push_back(p);
    }
    return points;
}

void add_instance(const View& view, const Instance& instance, FrameBlur& blur) {
    const Projection& projection = view.projection;
    const GeometryData& data = view.scene->geometry_of(instance);
    const Knots knots = combine_knots(*view.scene, instance, data, data.knots == 1);
    if (!knots.finite) return;
    std::vector<Vec2d> place;
    std::vector<double> path;
    for (int k = 0; k < knots.count; ++k) {
        const auto points = points_at(view, instance, knot_time(k, knots.count - 1, data.knots));
        place.resize(points.size());
        path.resize(points.size(), 0.0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            Vec3d p =
                transform_point(knots.camera_from_object[static_cast<std::size_t>(k)], points[i]);
            // What comes nearer than the near clip is not seen there.
            p.z = std::clamp(p.z, projection.near_clip, projection.far_clip);
            const double w = projection.perspective ? p.z : 1.0;
            const Vec2d now = projection.scale * Vec2d(p) / w;
            if (k > 0) path[i] += glm::length(now - place[i]);
            place[i] = now;
            blur.motion = std::fmax(blur.motion, path[i]);
            const double scale =
                std::max(std::fabs(projection.scale.x), std::fabs(projection.scale.y));
            blur.lens = std::fmax(blur.lens, scale * projection.lens_reach(p.z) / w);
        }
    }
}

}  // namespace

FrameBlur frame_blur(const View& view) {
    FrameBlur largest;
    std::mutex mutex;
    parallel_for(view.scene->instances.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        FrameBlur blur;
        for (std::size_t i = begin; i < end; ++i) {
            const Instance& instance = view.scene->instances[i];
            if (!instance.visible_camera) continue;
            const RasterBounds bounds = instance_bounds(view, i);
            if (!bounds.visible || bounds.x1 < view.raster_x0 || bounds.y1 < view.raster_y0 ||
                bounds.x0 > view.raster_x1 || bounds.y0 > view.raster_y1)
                continue;
            add_instance(view, instance, blur);
        }
        const std::lock_guard lock(mutex);
        largest.motion = std::fmax(largest.motion, blur.motion);
        largest.lens = std::fmax(largest.lens, blur.lens);
    });
    return largest;
}

int automatic_passes(const View& view, const PixelFilter& filter, Report& report) {
    const auto factor = [&](float d) { return filter.evaluate(d); };
    const double step = longest_step(factor, filter.radius());
    const FrameBlur blur = frame_blur(view);
    if (passes_wanted(blur, step) > kMostPasses)
        report.warn("render settings", "REGULAR sampling stops at " + std::to_string(kMostPasses) +
                                           " time samples; this frame's blur wants more, and "
                                           "copies may show");
    const int passes = pass_count(blur, step);
    return view.scene->has_lifespans() ? std::max(passes, kLifespanPasses) : passes;
}

}  // namespace granita
