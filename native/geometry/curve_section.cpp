// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/curve_section.h"

#include <algorithm>
#include <array>

#include "geometry/catmull_rom.h"
#include "scene/knot_time.h"

namespace granita {

CurveSection curve_section(const SharedElements& elements, const ElementPlace& place, double time) {
    const GeometryData& data = elements.data();
    const std::size_t count = data.vertex_count();
    const KnotTime at = knot_time(time, data.knots);
    // A knot's value, or between two.
    const auto timed = [&]<class T>(const std::vector<T>& values, std::size_t vertex, auto wide) {
        using Wide = decltype(wide);
        const bool moves = values.size() > count;
        const Wide first(values[(moves ? at.knot * count : 0) + vertex]);
        if (!moves || at.fraction == 0.0) return first;
        return first + (Wide(values[(at.knot + 1) * count + vertex]) - first) * at.fraction;
    };
    const std::size_t root = elements.first_point(place.element);
    const std::size_t last = root + elements.point_count(place.element) - 1;
    const std::array<std::size_t, 4> vertex{std::max(place.point, root + 1) - 1, place.point,
                                            place.next, std::min(place.next + 1, last)};
    const auto point = [&](std::size_t k) { return timed(data.points, vertex[k], Vec3d()); };
    const CatmullRom basis(place.fraction);
    CurveSection section;
    section.along =
        CatmullRom::sum<Vec3d>(basis.d, [&](int i) { return point(static_cast<std::size_t>(i)); });
    if (section.along == Vec3d(0.0)) section.along = point(2) - point(1);
    section.radius = std::max(
        CatmullRom::sum<double>(basis.w,
                                [&](int i) {
                                    return timed(data.radius, vertex[static_cast<std::size_t>(i)],
                                                 double());
                                }),
        0.0);
    return section;
}

}  // namespace granita
