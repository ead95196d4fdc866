// SPDX-License-Identifier: GPL-3.0-or-later
// Images and colour spaces: dicts of the snapshot to the scene.
#include <algorithm>
#include <cstring>

#include "python/snapshot.h"

namespace granita::python {

namespace {

/// [3,3] of rows; absent = nothing changes.
Mat3f read_matrix(const Record& r, const char* key) {
    const auto values = r.values<float>(key, {3, 3});
    r.require_finite<float>(key, values);
    Mat3f matrix(1.0f);
    for (std::size_t k = 0; k < values.size(); ++k)
        matrix[static_cast<int>(k % 3)][static_cast<int>(k / 3)] = values[k];
    return matrix;
}

}  // namespace

void read_color_space(const Record& r, NamedColorSpace& named) {
    using Curve = ColorSpace::Curve;
    auto space = std::make_shared<ColorSpace>();
    space->is_data = r.boolean("is_data", false);
    space->curve = static_cast<Curve>(
        choice(r, "curve", r.text("curve", "LINEAR"), {"LINEAR", "SRGB", "TABLE"}));
    space->matrix = read_matrix(r, "matrix");
    if (space->curve == Curve::Table) {
        space->table = r.values<float>("table", {-1});
        r.require_finite<float>("table", space->table);
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
        r.require_finite<float>("cube", {cube.data(), static_cast<std::size_t>(cube.size())});
        space->cube_size = static_cast<int>(size);
        space->cube.resize(static_cast<std::size_t>(size * size * size));
        std::memcpy(space->cube.data(), cube.data(), space->cube.size() * sizeof(Vec3f));
    }
    named.space = std::move(space);
}

void read_working_space(const Record& r, WorkingSpace& space) {
    space.from_rec709 = read_matrix(r, "from_rec709");
    const auto luminance = r.values<float>("luminance", {3});
    r.require_finite<float>("luminance", luminance);
    if (luminance.size() == 3) space.luminance = {luminance[0], luminance[1], luminance[2]};
}

void read_image(const Record& r, const std::vector<NamedColorSpace>& spaces, Image& image) {
    image.path = r.text("path", "");
    const std::string name = r.text("colorspace", "sRGB");
    const auto described = std::ranges::find(spaces, name, &NamedColorSpace::name);
    image.space = described != spaces.end() ? described->space : plain_color_space(name);
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
