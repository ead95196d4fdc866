// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/element_values.h"

#include <array>

#include "geometry/corner_values.h"
#include "math/hash.h"

namespace granita {
namespace {

/// Along the lines between points, the last but in part.
double length_to(const SharedElements& elements, std::size_t first, std::size_t point,
                 double fraction) {
    double length = 0.0;
    for (std::size_t v = first; v <= point; ++v) {
        const double part = v < point ? 1.0 : fraction;
        if (part > 0.0)
            length += part * glm::length(elements.frame_point(v + 1) - elements.frame_point(v));
    }
    return length;
}

double curve_length(const SharedElements& elements, std::uint32_t curve) {
    const std::size_t first = elements.first_point(curve), count = elements.point_count(curve);
    return count < 2 ? 0.0 : length_to(elements, first, first + count - 2, 1.0);
}

double curve_intercept(const SharedElements& elements, const ElementPlace& place) {
    const double length = curve_length(elements, place.element);
    if (!(length > 0.0)) return 0.0;
    const std::size_t first = elements.first_point(place.element);
    return length_to(elements, first, place.point,
                     place.next == place.point ? 0.0 : place.fraction) /
           length;
}

}  // namespace

float random_of_index(std::uint32_t index) {
    return static_cast<float>(hash_words(std::array<std::uint32_t, 2>{index, 0u}) /
                              static_cast<double>(0xffffffffu));
}

void element_value(const SharedElements& elements, const AttributeRequest& request,
                   const ElementPlace& place, float* out) {
    const std::size_t width = static_cast<std::size_t>(request.width);
    double value[4] = {0.0, 0.0, 0.0, 0.0};
    const auto set = [&](const Vec3d& v) {
        for (int i = 0; i < 3; ++i) value[i] = v[i];
        value[3] = 1.0;
    };
    const auto along = [&](const auto& at) {
        return at(place.point) * (1.0 - place.fraction) + at(place.next) * place.fraction;
    };
    const std::span<const Vec3f> other = neighbour_points(elements.data(), request.source);
    const auto position = [&](std::size_t v) {
        return other.empty() ? elements.frame_point(v) : Vec3d(other[v]);
    };
    if (request.source == AttributeSource::Generated) {
        // One place a hair, its root's, as in Cycles.
        const std::size_t root = elements.first_point(place.element);
        const std::vector<Vec3f>& known = elements.data().generated;
        set(known.empty() ? generated(elements.frame_box(), elements.frame_point(root))
                          : Vec3d(known[root]));
    } else if (is_position(request.source)) {
        set(along(position));
    } else if (request.source == AttributeSource::ElementRandom) {
        set(Vec3d(random_of_index(place.element)));
    } else if (request.source == AttributeSource::CurveLength) {
        set(Vec3d(curve_length(elements, place.element)));
    } else if (request.source == AttributeSource::CurveIntercept) {
        set(Vec3d(curve_intercept(elements, place)));
    } else if (request.source == AttributeSource::ElementRadius) {
        set(Vec3d(along([&](std::size_t v) { return elements.frame_radius(v); })));
    } else if (const Attribute* attribute = find_attribute(elements.data(), request)) {
        const std::size_t n = static_cast<std::size_t>(attribute->width);
        const auto component = [&](std::size_t element, std::size_t c) {
            return static_cast<double>(attribute->values[element * n + c]);
        };
        for (std::size_t c = 0; c < n; ++c)
            value[c] = attribute->domain == Domain::Point
                           ? along([&](std::size_t v) { return component(v, c); })
                           : component(place.element, c);
        if (n == 1) value[1] = value[2] = value[0];
        if (n < 4) value[3] = 1.0;
    }
    for (std::size_t c = 0; c < width; ++c) out[c] = static_cast<float>(value[c]);
}

}  // namespace granita
