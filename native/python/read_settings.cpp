// SPDX-License-Identifier: GPL-3.0-or-later
// Options and camera of the snapshot.
#include <algorithm>
#include <cmath>

#include "hider/samples/sample_table.h"
#include "python/snapshot.h"
#include "scene/channels.h"

namespace granita::python {
namespace {

int in_range(const Record& record, const char* key, int value, int lo, int hi) {
    if (value < lo || value > hi)
        record.fail(std::string("'") + key + "' is " + std::to_string(value) + ", expected " +
                    std::to_string(lo) + " to " + std::to_string(hi));
    return value;
}

float at_least(const Record& record, const char* key, double value, double lo) {
    if (!(value >= lo))
        record.fail(std::string("'") + key + "' is " + std::to_string(value) +
                    ", expected at least " + std::to_string(lo));
    return static_cast<float>(value);
}

void read_passes(const Record& r, Options& o) {
    for (const py::handle name : r.list("passes")) o.passes.push_back(py::cast<std::string>(name));
    if (std::find(o.passes.begin(), o.passes.end(), "Depth") != o.passes.end()) o.depth_pass = true;
    for (const py::handle item : r.list("aovs")) {
        const Record aov(py::cast<py::dict>(item), r.datablock());
        o.aovs.push_back({aov.text("name"),
                          choice(aov, "kind", aov.text("kind", "COLOR"), {"COLOR", "VALUE"}) == 0});
    }
    const ChannelSet checked(o);
    o.pass_alpha_threshold = static_cast<float>(r.number("pass_alpha_threshold", 0.0));
    const auto mist = r.values<float>("mist", {3});
    if (mist.empty()) return;
    o.mist = {mist[0], mist[1], mist[2]};
    if (!(o.mist.depth >= 0.0f && o.mist.exponent > 0.0f))
        r.fail("'mist' must have a depth of at least 0 and an exponent above 0");
}

std::vector<Vec2d> lens_knots(const Record& r, double widened) {
    const std::vector<double> values = r.values<double>("lens_knots", {-1, 2});
    std::vector<Vec2d> knots;
    for (std::size_t i = 0; i < values.size(); i += 2) {
        const Vec2d knot(values[i], values[i + 1]);
        if (!(knot.x >= 0.0 && knot.y > 0.0 && std::isfinite(knot.x) && std::isfinite(knot.y)))
            r.fail(
                "'lens_knots' must hold finite radii of at least 0 and finite focus distances "
                "above 0");
        knots.emplace_back(widened * knot.x, knot.y);
    }
    if (knots.empty()) r.fail("'lens_knots' must hold at least one knot");
    return knots;
}

}  // namespace

void read_options(const Record& r, Options& o) {
    constexpr int kMaxPixels = 65536;
    o.width = in_range(r, "width", r.integer("width", 0), 1, kMaxPixels);
    o.height = in_range(r, "height", r.integer("height", 0), 1, kMaxPixels);
    o.crop = {0, 0, o.width, o.height};
    if (const auto crop = r.values<std::int32_t>("crop", {4}); !crop.empty()) {
        o.crop = Rect{crop[0], crop[1], crop[2], crop[3]};
        if (o.crop.intersect({0, 0, o.width, o.height}) != o.crop || o.crop.empty())
            r.fail("'crop' must be a rectangle of at least one pixel inside the frame");
    }
    o.frame = r.integer("frame", 0);
    o.samples = in_range(r, "samples", r.integer("samples", o.samples), 1, 4096);
    o.noise_threshold =
        at_least(r, "noise_threshold", r.number("noise_threshold", o.noise_threshold), 0.0);
    o.min_samples = in_range(r, "min_samples", r.integer("min_samples", o.min_samples), 1, 4096);
    o.sampling = static_cast<Sampling>(choice(r, "sampling", r.text("sampling", "INDEPENDENT"),
                                              {"INDEPENDENT", "INTERLEAVED", "REGULAR"}));
    o.time_samples = in_range(r, "time_samples", r.integer("time_samples", 0), 0, 65536);
    o.pixel_filter =
        static_cast<FilterKind>(choice(r, "pixel_filter", r.text("pixel_filter", "BLACKMAN_HARRIS"),
                                       {"BOX", "TENT", "GAUSSIAN", "BLACKMAN_HARRIS", "MITCHELL",
                                        "CATMULL_ROM", "LANCZOS", "BSPLINE"}));
    o.filter_width = at_least(r, "filter_width", r.number("filter_width", o.filter_width), 0.01);
    o.dicing_rate = at_least(r, "dicing_rate", r.number("dicing_rate", o.dicing_rate), 0.01);
    o.shading_rate = at_least(r, "shading_rate", r.number("shading_rate", o.shading_rate), 0.0);
    o.motion_factor = at_least(r, "motion_factor", r.number("motion_factor", o.motion_factor), 0.0);
    o.focus_factor = at_least(r, "focus_factor", r.number("focus_factor", o.focus_factor), 0.0);
    o.grid_size = in_range(r, "grid_size", r.integer("grid_size", o.grid_size), 1, 65536);
    o.bucket_size =
        in_range(r, "bucket_size", r.integer("bucket_size", o.bucket_size), kTileSize, 4096);
    if (o.bucket_size % kTileSize) r.fail("'bucket_size' must be a multiple of 16 pixels");
    o.z_batch_size =
        in_range(r, "z_batch_size", r.integer("z_batch_size", o.z_batch_size), 1, 65536);
    o.opacity_threshold =
        at_least(r, "opacity_threshold", r.number("opacity_threshold", o.opacity_threshold), 0.0);
    o.list_memory = in_range(r, "list_memory", r.integer("list_memory", o.list_memory), 1, 1 << 20);
    o.memory = in_range(r, "memory", r.integer("memory", o.memory), 0, 1 << 30);
    o.seed = static_cast<std::uint32_t>(r.integer("seed", 0));
    o.light_samples =
        in_range(r, "light_samples", r.integer("light_samples", o.light_samples), 1, 65536);
    o.bounces.most = in_range(r, "bounces", r.integer("bounces", o.bounces.most), 0, 1024);
    o.bounces.diffuse =
        in_range(r, "diffuse_bounces", r.integer("diffuse_bounces", o.bounces.diffuse), 0, 1024);
    o.bounces.glossy =
        in_range(r, "glossy_bounces", r.integer("glossy_bounces", o.bounces.glossy), 0, 1024);
    o.bounces.transmission =
        in_range(r, "transmission_bounces",
                 r.integer("transmission_bounces", o.bounces.transmission), 0, 1024);
    o.bounces.volume =
        in_range(r, "volume_bounces", r.integer("volume_bounces", o.bounces.volume), 0, 1024);
    o.bounces.transparent = in_range(
        r, "transparent_bounces", r.integer("transparent_bounces", o.bounces.transparent), 0, 1024);
    o.bounces.reflective_caustics = r.boolean("reflective_caustics", o.bounces.reflective_caustics);
    o.bounces.refractive_caustics = r.boolean("refractive_caustics", o.bounces.refractive_caustics);
    o.bounces.filter_glossy =
        at_least(r, "filter_glossy", r.number("filter_glossy", o.bounces.filter_glossy), 0.0);
    o.bounces.clamp =
        at_least(r, "clamp_indirect", r.number("clamp_indirect", o.bounces.clamp), 0.0);
    o.bounces.occluded_from =
        in_range(r, "occluded_from", r.integer("occluded_from", o.bounces.occluded_from), 0, 1024);
    o.bounces.occlusion_distance = at_least(
        r, "occlusion_distance", r.number("occlusion_distance", o.bounces.occlusion_distance), 0.0);
    o.bounces.occlusion_factor = at_least(
        r, "occlusion_factor", r.number("occlusion_factor", o.bounces.occlusion_factor), 0.0);
    o.bounces.occlusion_added =
        at_least(r, "occlusion_added", r.number("occlusion_added", o.bounces.occlusion_added), 0.0);
    // It is found by rays, though they may go no further.
    if (o.bounces.occlusion_added > 0.0f && o.bounces.most == 0) {
        o.bounces.most = 1;
        o.bounces.diffuse = o.bounces.glossy = o.bounces.transmission = o.bounces.volume = 0;
    }
    o.refine_samples = r.boolean("refine_samples", o.refine_samples);
    o.shading_threshold =
        at_least(r, "shading_threshold", r.number("shading_threshold", o.shading_threshold), 0.0);
    o.device =
        static_cast<Device>(choice(r, "device", r.text("device", "AUTO"), {"AUTO", "CPU", "GPU"}));
    o.executor = static_cast<Executor>(choice(r, "executor", r.text("executor", "AUTO"),
                                              {"AUTO", "REFERENCE", "SIMD", "RASTER", "COMPUTE"}));
    o.threads = in_range(r, "threads", r.integer("threads", 0), 0, 1024);
    o.film_transparent = r.boolean("film_transparent", false);
    o.depth_pass = r.boolean("depth_pass", false);
    read_passes(r, o);
    o.frame_time = static_cast<float>(r.number("frame_time", 0.5));
    if (o.frame_time < 0.0f || o.frame_time > 1.0f) r.fail("'frame_time' must be between 0 and 1");
    o.shutter_curve = r.values<float>("shutter_curve", {-1});
    o.rolling_shutter = static_cast<float>(r.number("rolling_shutter", -1.0));
    if (o.rolling_shutter > 1.0f) r.fail("'rolling_shutter' must be at most 1");
    r.refuse_others();
}

void read_camera(const Record& r, Camera& camera) {
    camera.name = r.text("name", "Camera");
    camera.world_from_camera = matrices(r, "world_from_camera");
    if (camera.world_from_camera.empty()) r.fail("'world_from_camera' must hold at least one knot");
    if (r.has("adjacent")) camera.adjacent = matrices(r, "adjacent");
    if (!camera.adjacent.empty() && camera.adjacent.size() != 2)
        r.fail("'adjacent' must hold two matrices");
    Projection& p = camera.projection;
    p.perspective =
        choice(r, "kind", r.text("kind", "PERSPECTIVE"), {"PERSPECTIVE", "ORTHOGRAPHIC"}) == 0;
    p.scale = r.pair("scale");
    if (!(p.scale.x > 0.0 && p.scale.y > 0.0)) r.fail("'scale' must be positive");
    p.center = r.pair("center");
    if (r.has("clip")) {
        const Vec2d clip = r.pair("clip");
        p.near_clip = clip.x;
        p.far_clip = clip.y;
    }
    if (p.perspective && !(p.near_clip > 0.0)) r.fail("the near clip must be greater than 0");
    if (!(p.far_clip > p.near_clip)) r.fail("the far clip must lie behind the near clip");
    p.lens_ratio = r.number("lens_ratio", 1.0);
    if (!(p.lens_ratio > 0.0)) r.fail("the aperture ratio must be greater than 0");
    const double widened = std::max(1.0, 1.0 / p.lens_ratio);
    p.lens_radius = widened * r.number("lens_radius", 0.0);
    if (!(p.lens_radius >= 0.0)) r.fail("'lens_radius' must be at least 0");
    p.focus = r.number("focus_distance", p.focus);
    if (p.has_lens() && !(p.focus > 0.0)) r.fail("the focus distance must be greater than 0");
    if (r.has("lens_knots")) camera.lens = LensKnots(lens_knots(r, widened), p);
    camera.blades = r.integer("blades", 0);
    camera.blade_rotation = static_cast<float>(r.number("blade_rotation", 0.0));
    r.refuse_others();
}

}  // namespace granita::python
