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

py::dict statistics_dict(const RenderJob& job) {
    py::dict dict;
    for (const auto& [name, value] : job.statistics().list()) {
        const bool is_time = name.rfind("seconds_", 0) == 0;
        dict[name.c_str()] = is_time ? py::object(py::float_(value))
                                     : py::object(py::int_(static_cast<std::uint64_t>(value)));
    }
    dict["device"] = job.device();
    return dict;
}

py::list warning_list(const RenderJob& job) {
    py::list list;
    for (const Warning& w : job.report().warnings())
        list.append(py::make_tuple(w.datablock, w.message, w.count));
    return list;
}

py::dict render(const py::dict& snapshot) {
    const auto scene = read_scene(snapshot);
    const Rect& crop = scene->options.crop;
    std::vector<Vec4f> combined(static_cast<std::size_t>(crop.width()) *
                                static_cast<std::size_t>(crop.height()));
    std::vector<float> depth(scene->options.depth_pass ? combined.size() : 0);
    RenderJob job(scene);
    while (!job.done()) {
        std::vector<Tile> tiles;
        {
            const py::gil_scoped_release release;
            tiles = job.take_tiles(0.1);
        }
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        for (const Tile& tile : tiles) {
            const auto w = static_cast<std::size_t>(tile.rect.width());
            for (int y = 0; y < tile.rect.height(); ++y) {
                const std::size_t to = static_cast<std::size_t>(tile.rect.y0 + y - crop.y0) *
                                           static_cast<std::size_t>(crop.width()) +
                                       static_cast<std::size_t>(tile.rect.x0 - crop.x0);
                const std::size_t from = static_cast<std::size_t>(y) * w;
                std::copy_n(tile.combined.begin() + static_cast<std::ptrdiff_t>(from), w,
                            combined.begin() + static_cast<std::ptrdiff_t>(to));
                if (!depth.empty())
                    std::copy_n(tile.depth.begin() + static_cast<std::ptrdiff_t>(from), w,
                                depth.begin() + static_cast<std::ptrdiff_t>(to));
            }
        }
    }
    {
        const py::gil_scoped_release release;
        job.finish();
    }
    py::dict result;
    result["combined"] = to_array(combined, crop.width(), crop.height());
    result["depth"] = to_array(depth, crop.width(), crop.height());
    result["statistics"] = statistics_dict(job);
    result["warnings"] = warning_list(job);
    return result;
}

/// What Python holds: a checked scene.
struct SceneHandle {
    std::shared_ptr<const Scene> scene;
};

}  // namespace

void bind_render(py::module_& module) {
    py::class_<SceneHandle>(module, "Scene", py::module_local(),
                            "A checked frame (docs/scene_snapshot.md).")
        .def(py::init([](const py::dict& snapshot) { return SceneHandle{read_scene(snapshot)}; }),
             py::arg("snapshot"),
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
            "f32 [h,w] camera z in metres, or None");

    py::class_<RenderJob>(module, "Render", py::module_local(),
                          "A frame being rendered on its own threads.")
        .def(py::init([](const SceneHandle& handle) {
                 return std::make_unique<RenderJob>(handle.scene);
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
        .def("statistics", &statistics_dict)
        .def("warnings", &warning_list, "[(datablock, message, count)]");

    module.def("render", &render, py::arg("snapshot"),
               "Renders a snapshot: {'combined': f32 [h,w,4] of the crop, 'depth', 'statistics', "
               "'warnings'}.");
}

}  // namespace granita::python
