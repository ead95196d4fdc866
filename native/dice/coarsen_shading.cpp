// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/coarsen_shading.h"

#include <cmath>
#include <utility>

namespace granita {
namespace {

/// Vertices from one shaded point to the next along a row or column of `steps` micropolygons (a
/// power of two) from `first` on, `stride` apart.
int points_step(const Grid& grid, const Projection& projection, int first, int stride, int steps,
                double rate) {
    const std::vector<Vec3f>& p = grid.shading_p();
    const auto place = [&](int i) {
        const int vertex = first + i * stride;
        const Vec3d at(p[static_cast<std::size_t>(vertex)]);
        return projection.scale * Vec2d(at) / (projection.perspective ? at.z : 1.0);
    };
    double length = 0.0;
    for (int i = 0; i < steps; ++i) length += glm::distance(place(i), place(i + 1));
    int step = 1;
    // Distances end in (rate / sqrt 2, sqrt 2 rate], as those of vertices.
    while (steps % (2 * step) == 0 && 2 * step * length / steps <= M_SQRT2 * rate) step *= 2;
    return step;
}

template <class T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& anchors,
          std::size_t width = 1) {
    if (values.empty()) return;
    std::vector<T> kept;
    kept.reserve(anchors.size() * width);
    for (const std::uint32_t vertex : anchors)
        for (std::size_t c = 0; c < width; ++c) kept.push_back(values[vertex * width + c]);
    values = std::move(kept);
}

/// Differences between points that are so many steps apart.
template <class T>
void keep_steps(std::vector<T>& values, const std::vector<std::uint32_t>& anchors,
                std::size_t width, int steps) {
    keep(values, anchors, width);
    for (T& value : values) value *= static_cast<float>(steps);
}

}  // namespace

void coarsen_shading(Grid& grid, const Projection& projection, double rate) {
    const int row = grid.n_u + 1;
    const int u = points_step(grid, projection, grid.n_v / 2 * row, 1, grid.n_u, rate);
    const int v = points_step(grid, projection, grid.n_u / 2, row, grid.n_v, rate);
    if (u * v == 1) return;
    ShadingPositions& places = grid.shading_positions;
    places.step_u = u;
    places.step_v = v;
    for (int j = 0; j <= grid.n_v; j += v)
        for (int i = 0; i <= grid.n_u; i += u)
            places.anchors.push_back(static_cast<std::uint32_t>(j * row + i));
    if (grid.p.empty()) grid.p = grid.positions;
    for (std::vector<Vec3f>* values : {&grid.p, &grid.normal, &grid.geometric_normal})
        keep(*values, places.anchors);
    keep(grid.rise, places.anchors);
    keep(grid.normal_corners, places.anchors);
    keep_steps(grid.dp_du, places.anchors, 1, u);
    keep_steps(grid.dp_dv, places.anchors, 1, v);
    for (GridAttribute& attribute : grid.attributes) {
        const auto width = static_cast<std::size_t>(attribute.width);
        keep(attribute.values, places.anchors, width);
        keep_steps(attribute.du, places.anchors, width, u);
        keep_steps(attribute.dv, places.anchors, width, v);
    }
}

}  // namespace granita
