// SPDX-License-Identifier: GPL-3.0-or-later
// Reading the snapshot dict (docs/scene_snapshot.md): every access is checked and every error names
// the datablock.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/scene.h"

namespace granita::python {

namespace py = pybind11;

/// One dict of the snapshot together with the name that errors carry.
class Record {
  public:
    Record(py::dict dict, std::string datablock)
        : m_dict(std::move(dict)), m_datablock(std::move(datablock)) {}

    const std::string& datablock() const { return m_datablock; }
    Record named(std::string datablock) const { return {m_dict, std::move(datablock)}; }
    bool has(const char* key) const;
    py::object get(const char* key) const;  ///< throws SceneError when absent

    double number(const char* key) const;
    double number(const char* key, double fallback) const;
    int integer(const char* key, int fallback) const;
    bool boolean(const char* key, bool fallback) const;
    std::string text(const char* key) const;
    std::string text(const char* key, const std::string& fallback) const;
    Vec2d pair(const char* key) const;
    py::list list(const char* key) const;  ///< absent = empty
    Record record(const char* key) const;

    /// A C-contiguous array of element type T (converted from any numeric dtype of the same kind),
    /// whose shape is `shape` where -1 stands for any length.
    template <class T>
    py::array_t<T, py::array::c_style | py::array::forcecast> array(
        const char* key, const std::vector<py::ssize_t>& shape) const;
    /// The same as a vector; absent = empty.
    template <class T>
    std::vector<T> values(const char* key, const std::vector<py::ssize_t>& shape) const;

    /// Fails where one of the values of a key is infinite or no number.
    template <class T>
    void require_finite(const char* key, std::span<const T> values) const {
        if (!std::ranges::all_of(values, [](T x) { return std::isfinite(x); }))
            fail(std::string("'") + key + "' holds a value that is not finite");
    }

    [[noreturn]] void fail(const std::string& message) const;
    /// Fails where the dict has a key that nobody asked for: a name spelled wrongly.
    void refuse_others() const;

  private:
    py::dict m_dict;
    std::string m_datablock;
    mutable std::vector<const char*> m_asked;
};

/// Calls `read(record)`.  A value that Python cannot convert is refused by the record's name; what
/// is no error of a value (Ctrl-C, no memory) goes on.
template <class Read>
void read_checked(const Record& record, Read read) {
    try {
        read(record);
    } catch (const py::builtin_exception&) {
        record.fail("holds a value of the wrong type");
    } catch (const py::error_already_set& error) {
        if (!error.matches(PyExc_Exception) || error.matches(PyExc_MemoryError)) throw;
        record.fail("holds a value of the wrong type");
    }
}

/// The index of `text` in the identifiers, or a SceneError that lists them.
int choice(const Record& record, const char* key, const std::string& value,
           const std::vector<const char*>& identifiers);

/// When a thing exists.  The shutter's end is a time like others: 1 means to its end and with it.
/// Throws a SceneError where these ends are no interval, or no numbers.
Lifespan lifespan(const std::string& datablock, float open, float close);

/// [n,4,4] row-major f64 -> matrices; checked finite.
std::vector<Mat4d> matrices(const Record& record, const char* key);

void read_options(const Record& record, Options& options);
void read_camera(const Record& record, Camera& camera);
void read_geometry(const Record& record, GeometryData& geometry);
void read_instances(const Record& record, Scene& scene);
void read_graph(const Record& record, NodeGraph& graph);
void read_light(const Record& record, Light& light);
/// Light::most_bounces, of a world too.
int read_most_bounces(const Record& record);

struct NamedColorSpace {
    std::string name;
    std::shared_ptr<const ColorSpace> space;
};
void read_color_space(const Record& record, NamedColorSpace& space);
void read_working_space(const Record& record, WorkingSpace& space);
/// @param spaces  those that are not plain (scene/color_space.h).
void read_image(const Record& record, const std::vector<NamedColorSpace>& spaces, Image& image);
std::shared_ptr<Scene> read_scene(const py::dict& snapshot);

void bind_errors(py::module_& module);
void bind_render(py::module_& module);
void bind_system(py::module_& module);

}  // namespace granita::python
