// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/color_space.h"

#include <algorithm>
#include <cmath>

#include "math/observer.h"
#include "math/saturate.h"
#include "math/srgb.h"

namespace granita {

namespace {

/// OpenColorIO's goes straight on below 0.
float whole_srgb(float x) {
    return x < 0.0f ? x / 12.92f : linear_from_srgb(x);
}

/// Beyond a table's end, as powers go on: what is divided by little alpha lies there.
float beyond(const ColorSpace& space, float x) {
    // A fifth before its end: neighbours hardly differ in single precision.
    const std::size_t last = space.table.size() - 1, at = last - std::max<std::size_t>(last / 5, 1);
    const float part = static_cast<float>(at) / static_cast<float>(last);
    const float end = space.table.back();
    const float power = std::log(end / space.table[at]) /
                        std::log(space.high / glm::mix(space.low, space.high, part));
    const float found = end * std::pow(x / space.high, power);
    return std::isfinite(found) ? found : end;
}

/// Between the numbers of a table, straight on below it.
float look_up(const ColorSpace& space, float x) {
    if (x > space.high) return beyond(space, x);
    const auto last = static_cast<float>(space.table.size() - 1);
    const float place = (x - space.low) / (space.high - space.low) * last;
    const float begin = place > 0.0f ? std::floor(std::min(place, last - 1.0f)) : 0.0f;
    const auto i = static_cast<std::size_t>(begin);
    return glm::mix(space.table[i], space.table[i + 1], place - begin);
}

/// Within the tetrahedron of a cube's corners about it, along whose diagonal grey lies: greys are
/// mixed of greys.
Vec3f look_up_cube(const ColorSpace& space, const Vec3f& color) {
    const int last = space.cube_size - 1;
    std::size_t corner = 0;
    std::size_t steps[3];
    Vec3f part;
    for (int k = 0, step = 1; k < 3; ++k, step *= space.cube_size) {
        const float place = saturate(color[k]) * static_cast<float>(last);
        const int at = std::min(static_cast<int>(place), last - 1);
        part[k] = place - static_cast<float>(at);
        steps[k] = static_cast<std::size_t>(step);
        corner += static_cast<std::size_t>(at) * steps[k];
    }
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int a, int b) { return part[a] > part[b]; });
    Vec3f sum = space.cube[corner] * (1.0f - part[order[0]]);
    for (int k = 0; k < 3; ++k) {
        corner += steps[order[k]];
        sum += space.cube[corner] * (part[order[k]] - (k < 2 ? part[order[k + 1]] : 0.0f));
    }
    return sum;
}

}  // namespace

Vec3f ColorSpace::linear(const Vec3f& color) const {
    if (cube_size > 0) return look_up_cube(*this, color);
    Vec3f c = color;
    for (int k = 0; k < 3 && curve != Curve::Linear; ++k)
        c[k] = curve == Curve::Srgb ? whole_srgb(c[k]) : look_up(*this, c[k]);
    return matrix == Mat3f(1.0f) ? c : matrix * c;
}

std::shared_ptr<const ColorSpace> plain_color_space(std::string_view name) {
    const auto made = [](ColorSpace::Curve curve, bool is_data) {
        auto space = std::make_shared<ColorSpace>();
        space->curve = curve;
        space->is_data = is_data;
        return std::shared_ptr<const ColorSpace>(space);
    };
    static const auto kSrgb = made(ColorSpace::Curve::Srgb, false);
    static const auto kLinear = made(ColorSpace::Curve::Linear, false);
    static const auto kData = made(ColorSpace::Curve::Linear, true);
    if (name == "sRGB") return kSrgb;
    if (name == "scene_linear") return kLinear;
    return name == "Non-Color" ? kData : nullptr;
}

Vec3f WorkingSpace::from_xyz(const Vec3f& xyz) const {
    return from_rec709 * rgb_of_xyz(xyz);
}

}  // namespace granita
