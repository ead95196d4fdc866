// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/snapshot.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace granita::python {
namespace {

void read_world(const Record& r, World& world) {
    world.name = r.text("name", "World");
    world.lights_scene = r.boolean("lights_scene", true);
    world.visible_camera = r.boolean("visible_camera", true);
    world.visible_diffuse = r.boolean("visible_diffuse", true);
    world.visible_glossy = r.boolean("visible_glossy", true);
    world.visible_transmission = r.boolean("visible_transmission", true);
    world.visible_volume = r.boolean("visible_volume", true);
    world.most_bounces = read_most_bounces(r);
    read_graph(r, world.graph);
}

std::string shape_text(const std::vector<py::ssize_t>& shape) {
    std::string text = "[";
    for (const auto n : shape)
        text += (text.size() > 1 ? ", " : "") + (n < 0 ? "any" : std::to_string(n));
    return text + "]";
}

}  // namespace

void Record::fail(const std::string& message) const {
    throw SceneError(m_datablock, message);
}

void Record::refuse_others() const {
    for (const auto& [key, value] : m_dict) {
        const auto name = py::cast<std::string>(key);
        if (std::find(m_asked.begin(), m_asked.end(), name) == m_asked.end())
            fail("'" + name + "' is unknown");
    }
}

bool Record::has(const char* key) const {
    m_asked.push_back(key);
    return m_dict.contains(key) && !m_dict[key].is_none();
}

py::object Record::get(const char* key) const {
    if (!has(key)) fail(std::string("'") + key + "' is missing");
    return m_dict[key];
}

double Record::number(const char* key) const {
    try {
        const double value = py::cast<double>(get(key));
        if (!std::isfinite(value)) fail(std::string("'") + key + "' must be finite");
        return value;
    } catch (const py::cast_error&) {
        fail(std::string("'") + key + "' must be a number");
    }
}

double Record::number(const char* key, double fallback) const {
    return has(key) ? number(key) : fallback;
}

int Record::integer(const char* key, int fallback) const {
    if (!has(key)) return fallback;
    const double value = number(key);
    if (value != std::floor(value) || std::abs(value) > 2147483647.0)
        fail(std::string("'") + key + "' must be a whole number");
    return static_cast<int>(value);
}

bool Record::boolean(const char* key, bool fallback) const {
    return has(key) ? number(key) != 0.0 : fallback;
}

std::string Record::text(const char* key) const {
    try {
        return py::cast<std::string>(get(key));
    } catch (const py::cast_error&) {
        fail(std::string("'") + key + "' must be text");
    }
}

std::string Record::text(const char* key, const std::string& fallback) const {
    return has(key) ? text(key) : fallback;
}

Vec2d Record::pair(const char* key) const {
    const auto v = values<double>(key, {2});
    if (v.size() != 2) fail(std::string("'") + key + "' is missing");
    return {v[0], v[1]};
}

py::list Record::list(const char* key) const {
    if (!has(key)) return py::list();
    const py::object value = get(key);
    if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value))
        fail(std::string("'") + key + "' must be a list");
    return py::list(value);
}

Record Record::record(const char* key) const {
    const py::object value = get(key);
    if (!py::isinstance<py::dict>(value)) fail(std::string("'") + key + "' must be a dict");
    return {py::cast<py::dict>(value), m_datablock + " " + key};
}

template <class T>
py::array_t<T, py::array::c_style | py::array::forcecast> Record::array(
    const char* key, const std::vector<py::ssize_t>& shape) const {
    const std::string name = std::string("'") + key + "'";
    const auto any = py::array::ensure(get(key));
    if (!any) {
        PyErr_Clear();
        fail(name + " must be an array");
    }
    const char kind = any.dtype().kind();
    const bool is_integer = kind == 'i' || kind == 'u' || kind == 'b';
    // An empty list arrives as float64.
    if (!(is_integer || (kind == 'f' && (std::is_floating_point_v<T> || any.size() == 0))))
        fail(name + " has dtype " + py::cast<std::string>(py::str(any.dtype())) + ", expected " +
             (std::is_floating_point_v<T> ? "floats" : "integers"));
    bool matches = any.ndim() == static_cast<py::ssize_t>(shape.size());
    for (py::ssize_t i = 0; matches && i < any.ndim(); ++i)
        matches = shape[i] < 0 || any.shape(i) == shape[i];
    if (!matches) {
        std::vector<py::ssize_t> given(any.shape(), any.shape() + any.ndim());
        fail(name + " must have shape " + shape_text(shape) + ", has " + shape_text(given));
    }
    return py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(any);
}

template <class T>
std::vector<T> Record::values(const char* key, const std::vector<py::ssize_t>& shape) const {
    if (!has(key)) return {};
    const auto a = array<T>(key, shape);
    return {a.data(), a.data() + a.size()};
}

template std::vector<float> Record::values(const char*, const std::vector<py::ssize_t>&) const;
template std::vector<double> Record::values(const char*, const std::vector<py::ssize_t>&) const;
template std::vector<std::int32_t> Record::values(const char*,
                                                  const std::vector<py::ssize_t>&) const;
template std::vector<std::uint32_t> Record::values(const char*,
                                                   const std::vector<py::ssize_t>&) const;
template std::vector<std::uint64_t> Record::values(const char*,
                                                   const std::vector<py::ssize_t>&) const;
template std::vector<std::uint8_t> Record::values(const char*,
                                                  const std::vector<py::ssize_t>&) const;
template py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast> Record::array(
    const char*, const std::vector<py::ssize_t>&) const;
template py::array_t<float, py::array::c_style | py::array::forcecast> Record::array(
    const char*, const std::vector<py::ssize_t>&) const;
template py::array_t<double, py::array::c_style | py::array::forcecast> Record::array(
    const char*, const std::vector<py::ssize_t>&) const;

int choice(const Record& record, const char* key, const std::string& value,
           const std::vector<const char*>& identifiers) {
    for (std::size_t i = 0; i < identifiers.size(); ++i)
        if (value == identifiers[i]) return static_cast<int>(i);
    std::string known;
    for (const char* identifier : identifiers)
        known += std::string(known.empty() ? "" : ", ") + identifier;
    record.fail(std::string("'") + key + "' is '" + value + "', expected one of " + known);
}

Lifespan lifespan(const std::string& datablock, float open, float close) {
    if (!(open <= close))
        throw SceneError(datablock, "'lifespan' is not an interval: " + std::to_string(open) +
                                        " to " + std::to_string(close));
    Lifespan life;
    life.open = open;
    if (close < 1.0f) life.close = close;
    return life;
}

std::vector<Mat4d> matrices(const Record& record, const char* key) {
    const auto a = record.array<double>(key, {-1, 4, 4});
    record.require_finite<double>(key, {a.data(), static_cast<std::size_t>(a.size())});
    std::vector<Mat4d> list(static_cast<std::size_t>(a.shape(0)));
    const double* m = a.data();
    for (Mat4d& matrix : list) {
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column) matrix[column][row] = *m++;
    }
    return list;
}

std::shared_ptr<Scene> read_scene(const py::dict& snapshot) {
    const Record root(snapshot, "scene");
    auto scene = std::make_shared<Scene>();
    const auto read_one = [&](const char* key, auto& target, auto read) {
        read_checked(root.record(key), [&](const Record& r) { read(r, target); });
    };
    read_one("options", scene->options, read_options);
    const Record camera = root.record("camera");
    read_checked(camera.named("camera '" + camera.text("name", "Camera") + "'"),
                 [&](const Record& r) { read_camera(r, scene->camera); });

    const auto read_list = [&](const char* key, const char* kind, auto& target, auto read) {
        for (const py::handle item : root.list(key)) {
            if (!py::isinstance<py::dict>(item))
                root.fail(std::string("'") + key + "' must hold dicts");
            const Record unnamed(py::reinterpret_borrow<py::dict>(item), kind);
            const std::string name = unnamed.text("name");
            // Geometry names already say what they are ("mesh 'Cube'").
            const bool named = name.find('\'') != std::string::npos;
            target.emplace_back();
            target.back().name = name;
            read_checked(unnamed.named(named ? name : std::string(kind) + " '" + name + "'"),
                         [&](const Record& r) { read(r, target.back()); });
        }
    };
    read_list("geometries", "mesh", scene->geometries, read_geometry);
    read_list("materials", "material", scene->materials, [](const Record& r, Material& m) {
        m.index = r.integer("index", 0);
        m.holdout = r.boolean("holdout", false);
        read_graph(r, m.graph);
    });
    std::vector<NamedColorSpace> spaces;
    read_list("color_spaces", "colour space", spaces, read_color_space);
    read_list("images", "image", scene->images,
              [&](const Record& r, Image& image) { read_image(r, spaces, image); });
    if (root.has("working_space"))
        read_one("working_space", scene->working_space, read_working_space);
    read_list("lights", "light", scene->lights, read_light);
    if (root.has("world")) read_one("world", scene->world, read_world);
    if (root.has("instances")) read_one("instances", *scene, read_instances);
    return scene;
}

}  // namespace granita::python
