// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl.h>

#include <cstring>

#include "python/snapshot.h"
#include "render/render_job.h"

namespace granita::python {
namespace {

/// Pixels of a tile or frame as arrays of their own: no reference into native memory leaves.
py::array_t<float> to_array(const std::vector<Vec4f>& pixels, int width, int height) {
    py::array_t<float> a({height, width, 4});
    std::memcpy(a.mutable_data(), pixels.data(), pixels.size() * sizeof(Vec4f));
    return a;
}

py::object to_array(const std::vector<float>& pixels, int width, int height) {
    if (pixels.empty()) return py::none();
    py::array_t<float> a({height, width});
    std::memcpy(a.mutable_data(), pixels.data(), pixels.size() * sizeof(float));
    return a;
}

py::dict pass_dict(const std::vector<TilePass>& passes, int width, int height) {
    py::dict dict;
    for (const TilePass& pass : passes) {
        py::array_t<float> a({height, width, pass.width});
        std::memcpy(a.mutable_data(), pass.values.data(), pass.values.size() * sizeof(float));
        dict[pass.name.c_str()] = a;
    }
    return dict;
}

py::dict statistics_dict(const RenderJob& job) {
    py::dict dict;
    for (const auto& [name, value] : job.statistics().list()) {
        const bool is_time = name.rfind("seconds_", 0) == 0;
        dict[name.c_str()] = is_time ? py::object(py::float_(value))
                                     : py::object(py::int_(static_cast<std::uint64_t>(value)));
    }
    dict["device"] = job.device();
    const gl::DeviceUse use = job.device_use();
    dict["seconds_device"] = use.seconds;
    dict["seconds_device_hidden"] = use.hidden_seconds;
    return dict;
}

py::list warning_list(const RenderJob& job) {
    py::list list;
    for (const Warning& w : job.report().warnings())
        list.append(py::make_tuple(w.datablock, w.message, w.count));
    return list;
}

py::list bucket_seconds(const RenderJob& job) {
    py::list list;
    for (const auto& [pixels, seconds] : job.bucket_seconds())
        list.append(py::make_tuple(pixels.x0, pixels.y0, pixels.x1, pixels.y1, seconds));
    return list;
}

/// Copies a tile's values, `width` floats a pixel, to their place in the crop's.
template <class T>
void paste(const Tile& tile, const Rect& crop, const std::vector<T>& from, std::size_t width,
           std::vector<T>& to) {
    const std::size_t row = static_cast<std::size_t>(tile.rect.width()) * width;
    for (int y = 0; y < tile.rect.height(); ++y) {
        const std::size_t pixel = static_cast<std::size_t>(tile.rect.y0 + y - crop.y0) *
                                      static_cast<std::size_t>(crop.width()) +
                                  static_cast<std::size_t>(tile.rect.x0 - crop.x0);
        std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * row),
                    row, to.begin() + static_cast<std::ptrdiff_t>(pixel * width));
    }
}

py::dict render(const py::dict& snapshot) {
    const std::shared_ptr<const Scene> scene = read_scene(snapshot);
    const Rect& crop = scene->options.crop;
    const std::size_t pixels =
        static_cast<std::size_t>(crop.width()) * static_cast<std::size_t>(crop.height());
    std::vector<Vec4f> combined(pixels);
    std::vector<float> depth(scene->options.depth_pass ? pixels : 0);
    std::vector<TilePass> passes;
    const ChannelSet channels(scene->options);
    for (const Pass& pass : channels.passes())
        passes.push_back({pass.name, pass.width, std::vector<float>(pixels * pass.width)});
    RenderJob job(scene);
    while (!job.done()) {
        std::vector<Tile> tiles;
        {
            const py::gil_scoped_release release;
            tiles = job.take_tiles(0.1);
        }
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        for (const Tile& tile : tiles) {
            paste(tile, crop, tile.combined, 1, combined);
            if (!depth.empty()) paste(tile, crop, tile.depth, 1, depth);
            for (std::size_t i = 0; i < passes.size(); ++i)
                paste(tile, crop, tile.passes[i].values, static_cast<std::size_t>(passes[i].width),
                      passes[i].values);
        }
    }
    {
        const py::gil_scoped_release release;
        job.finish();
    }
    py::dict result;
    result["combined"] = to_array(combined, crop.width(), crop.height());
    result["depth"] = to_array(depth, crop.width(), crop.height());
    result["passes"] = pass_dict(passes, crop.width(), crop.height());
    result["statistics"] = statistics_dict(job);
    result["warnings"] = warning_list(job);
    return result;
}

/// What Python holds: a checked scene.
struct SceneHandle {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<Session> session;
};

}  // namespace

void bind_render(py::module_& module) {
    py::class_<Session, std::shared_ptr<Session>>(
        module, "Session", py::module_local(),
        "What outlives a picture: scenes that are made with one share what is the same in them.")
        .def(py::init<>())
        .def_property_readonly("geometries_adopted", &Session::geometries_adopted)
        .def_property_readonly("geometries_made", &Session::geometries_made)
        .def_property_readonly("ray_shapes_made", &Session::ray_shapes_made);

    py::class_<SceneHandle>(module, "Scene", py::module_local(),
                            "A checked frame (docs/scene_snapshot.md).")
        .def(py::init([](const py::dict& snapshot, const std::shared_ptr<Session>& session) {
                 const std::shared_ptr<Scene> scene = read_scene(snapshot);
                 if (session) session->adopt(*scene);
                 return SceneHandle{scene, session};
             }),
             py::arg("snapshot"), py::arg("session") = nullptr,
             "Copies and checks the snapshot. Raises SceneError, which names the datablock.");

    py::class_<Tile>(module, "Tile", py::module_local(), "A finished rectangle of the picture.")
        .def_property_readonly(
            "x", [](const Tile& t) { return t.rect.x0; }, "left pixel, of the frame")
        .def_property_readonly(
            "y", [](const Tile& t) { return t.rect.y0; }, "lowest pixel, of the frame")
        .def_property_readonly(
            "combined",
            [](const Tile& t) { return to_array(t.combined, t.rect.width(), t.rect.height()); },
            "f32 [h,w,4] premultiplied linear RGBA, lowest row first")
        .def_property_readonly(
            "depth",
            [](const Tile& t) { return to_array(t.depth, t.rect.width(), t.rect.height()); },
            "f32 [h,w] camera z in metres, or None")
        .def_property_readonly(
            "passes",
            [](const Tile& t) { return pass_dict(t.passes, t.rect.width(), t.rect.height()); },
            "{name: f32 [h,w,channels]} of the other passes that were asked for");

    py::class_<RenderJob>(module, "Render", py::module_local(),
                          "A frame being rendered on its own threads.")
        .def(py::init([](const SceneHandle& handle) {
                 return std::make_unique<RenderJob>(handle.scene, kHardware, handle.session);
             }),
             py::arg("scene"))
        .def("take_tiles", &RenderJob::take_tiles, py::arg("seconds"),
             py::call_guard<py::gil_scoped_release>(),
             "Finished tiles; waits at most so many seconds for the first.")
        .def("done", &RenderJob::done, "No tile will come any more.")
        .def("cancel", &RenderJob::cancel)
        .def("finish", &RenderJob::finish, py::call_guard<py::gil_scoped_release>(),
             "Joins the threads; raises what stopped them.")
        .def_property_readonly("fraction", &RenderJob::fraction)
        .def_property_readonly("buckets_done", &RenderJob::buckets_done)
        .def_property_readonly("buckets_total", &RenderJob::buckets_total)
        .def_property_readonly("device", &RenderJob::device)
        .def("bucket_seconds", &bucket_seconds,
             "[(x0, y0, x1, y1, seconds)] of each bucket's pixels, once the frame is finished.")
        .def("statistics", &statistics_dict)
        .def(
            "dearest_objects",
            [](const RenderJob& job, std::size_t most) {
                py::list list;
                for (const DearObject& object : job.dearest_objects(most))
                    list.append(py::make_tuple(object.name, object.seconds, object.micropolygons));
                return list;
            },
            py::arg("most"),
            "[(name, seconds of threads at its grids, micropolygons)], dearest first.")
        .def("warnings", &warning_list, "[(datablock, message, count)]");

    module.def("render", &render, py::arg("snapshot"),
               "Renders a snapshot: {'combined': f32 [h,w,4] of the crop, 'depth', 'passes', "
               "'statistics', 'warnings'}.");
}

}  // namespace granita::python
