// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/element_values.h"

#include "geometry/corner_values.h"

namespace granita {

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
        set(generated(elements.frame_box(), position(elements.first_point(place.element))));
    } else if (is_position(request.source)) {
        set(along(position));
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
