// SPDX-License-Identifier: GPL-3.0-or-later
// Images and colour spaces: dicts of the snapshot to the scene.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "python/snapshot.h"

namespace granita::python {

namespace {

template <class T>
void require_finite(const Record& r, const char* key, const std::vector<T>& values) {
    if (!std::all_of(values.begin(), values.end(), [](T x) { return std::isfinite(x); }))
        r.fail(std::string("'") + key + "' holds a value that is not finite");
}

/// [3,3] of rows; absent = nothing changes.
Mat3f read_matrix(const Record& r, const char* key) {
    const auto values = r.values<float>(key, {3, 3});
    require_finite(r, key, values);
    Mat3f matrix(1.0f);
    for (std::size_t k = 0; k < values.size(); ++k)
        matrix[static_cast<int>(k % 3)][static_cast<int>(k / 3)] = values[k];
    return matrix;
}

std::shared_ptr<const ColorSpace> read_color_space(const Record& r) {
    using Curve = ColorSpace::Curve;
    auto space = std::make_shared<ColorSpace>();
    space->is_data = r.boolean("is_data", false);
    space->curve = static_cast<Curve>(
        choice(r, "curve", r.text("curve", "LINEAR"), {"LINEAR", "SRGB", "TABLE"}));
    space->matrix = read_matrix(r, "matrix");
    if (space->curve == Curve::Table) {
        space->table = r.values<float>("table", {-1});
        require_finite(r, "table", space->table);
        space->low = static_cast<float>(r.number("low"));
        space->high = static_cast<float>(r.number("high"));
        if (space->table.size() < 2 || !(space->low < space->high))
            r.fail("its table has no two places");
    }
    if (r.has("cube")) {
        const auto cube = r.array<float>("cube", {-1, -1, -1, 3});
        const auto size = cube.shape(0);
        if (size < 2 || size > 256 || cube.shape(1) != size || cube.shape(2) != size)
            r.fail("its cube must have 2 to 256 numbers along each edge");
        space->cube_size = static_cast<int>(size);
        space->cube.resize(static_cast<std::size_t>(size * size * size));
        std::memcpy(space->cube.data(), cube.data(), space->cube.size() * sizeof(Vec3f));
        require_finite(r, "cube", std::vector<float>(cube.data(), cube.data() + cube.size()));
    }
    return space;
}

}  // namespace

ColorSpaces read_color_spaces(const Record& root) {
    ColorSpaces found;
    for (const py::handle item : root.list("color_spaces")) {
        if (!py::isinstance<py::dict>(item)) root.fail("'color_spaces' must hold dicts");
        const auto dict = py::reinterpret_borrow<py::dict>(item);
        const std::string name = Record(dict, "colour space").text("name");
        found[name] = read_color_space(Record(dict, "colour space '" + name + "'"));
    }
    return found;
}

void read_working_space(const Record& r, WorkingSpace& space) {
    space.from_rec709 = read_matrix(r, "from_rec709");
    const auto luminance = r.values<float>("luminance", {3});
    require_finite(r, "luminance", luminance);
    if (luminance.size() == 3) space.luminance = {luminance[0], luminance[1], luminance[2]};
}

void read_image(const Record& r, const ColorSpaces& spaces, Image& image) {
    image.path = r.text("path", "");
    const std::string name = r.text("colorspace", "sRGB");
    const auto described = spaces.find(name);
    image.space = described != spaces.end() ? described->second : plain_color_space(name);
    if (!image.space) r.fail("its colour space '" + name + "' is not described");
    image.alpha_mode = r.text("alpha_mode", "STRAIGHT");
    const auto take = [&](const auto& array, auto& texels) {
        image.height = static_cast<int>(array.shape(0));
        image.width = static_cast<int>(array.shape(1));
        texels.assign(array.data(), array.data() + array.size());
    };
    if (r.has("pixels")) take(r.array<float>("pixels", {-1, -1, 4}), image.pixels);
    if (r.has("bytes")) {
        if (!image.pixels.empty()) r.fail("has both 'pixels' and 'bytes'");
        take(r.array<std::uint8_t>("bytes", {-1, -1, 4}), image.bytes);
    }
}

}  // namespace granita::python
