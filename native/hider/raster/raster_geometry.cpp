// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_geometry.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/check.h"
#include "dice/raster_bound.h"
#include "hider/micropolygon.h"
#include "hider/micropolygon_class.h"

namespace granita {
namespace {

/// Triangles that are drawn together, from as many small grids as that takes: large enough that the
/// device and not the command is the cost, small enough that culling still works.
constexpr std::uint32_t kCombinedIndices = 6 * 256;

RasterBounds united(const RasterBounds& a, const RasterBounds& b) {
    if (!a.visible || !b.visible) return a.visible ? a : b;
    return {std::min(a.x0, b.x0),
            std::min(a.y0, b.y0),
            std::max(a.x1, b.x1),
            std::max(a.y1, b.y1),
            std::max(a.nearest_key, b.nearest_key),
            true};
}

}  // namespace

RasterGeometry::RasterGeometry(std::span<const GridSweep* const> sweeps) : m_inputs(sweeps.size()) {
    std::iota(m_inputs.begin(), m_inputs.end(), 0u);
    std::stable_sort(m_inputs.begin(), m_inputs.end(), [&](std::uint32_t a, std::uint32_t b) {
        return sweeps[a]->grid().key < sweeps[b]->grid().key;
    });
    std::size_t positions = 0, micropolygons = 0;
    for (const GridSweep* sweep : sweeps) {
        const Grid& grid = sweep->grid();
        positions += static_cast<std::size_t>(grid.vertex_count()) * sweep->boxes().size();
        micropolygons += static_cast<std::size_t>(grid.micropolygon_count());
    }
    // Names, index offsets and the shader's 3 i are 32 bits; 0 stands for no surface.
    const std::size_t largest = std::max(3 * positions, 6 * micropolygons);
    GRANITA_CHECK_LT(largest, std::numeric_limits<std::uint32_t>::max());
    m_positions.reserve(positions);
    Triangles triangles;
    for (const std::uint32_t input : m_inputs) {
        m_grids.push_back(&sweeps[input]->grid());
        append(*sweeps[input], triangles);
    }
    m_indices = std::move(triangles.opaque);
    const auto opaque = static_cast<std::uint32_t>(m_indices.size());
    m_indices.insert(m_indices.end(), triangles.transparent.begin(), triangles.transparent.end());
    for (Range& range : m_transparent) range.first_index += opaque;
}

void RasterGeometry::append(const GridSweep& sweep, Triangles& triangles) {
    const Grid& grid = sweep.grid();
    const auto index = static_cast<std::uint32_t>(m_places.size());
    const auto base = static_cast<std::uint32_t>(m_vertex_grids.size());
    const auto vertices = static_cast<std::uint32_t>(grid.vertex_count());
    const auto knots = static_cast<std::uint32_t>(sweep.boxes().size());
    m_places.push_back(
        {base, static_cast<std::uint32_t>(m_positions.size()), vertices, knots, grid.lifespan});
    m_vertex_grids.insert(m_vertex_grids.end(), vertices, index);
    // Static: all knots are equal.
    m_positions.insert(m_positions.end(), grid.positions.begin(),
                       grid.positions.begin() + static_cast<std::ptrdiff_t>(vertices) * knots);

    const GridClasses& classes = sweep.classes();
    if (classes.dropped > 0) m_dropped.push_back({&grid, classes.dropped});
    const std::size_t first_opaque = triangles.opaque.size();
    const std::size_t first_transparent = triangles.transparent.size();
    for (int m = 0; m < grid.micropolygon_count(); ++m) {
        const unsigned kind = classes.classes[m];
        if (kind == 0) continue;
        ++m_micropolygons;
        auto& list = kind & kTransparent ? triangles.transparent : triangles.opaque;
        const Grid::Corners c = grid.corners(m);
        const auto add = [&](int a, int b) {
            for (const int v : {c.v0, a, b}) list.push_back(base + static_cast<std::uint32_t>(v));
        };
        if (kind & kTriangleA) add(c.v1, c.v2);
        if (kind & kTriangleB) add(c.v2, c.v3);
    }
    append_range(m_opaque, sweep, static_cast<std::uint32_t>(first_opaque), triangles.opaque.size(),
                 true);
    append_range(m_transparent, sweep, static_cast<std::uint32_t>(first_transparent),
                 triangles.transparent.size(), false);
}

void RasterGeometry::append_range(std::vector<Range>& ranges, const GridSweep& sweep,
                                  std::uint32_t first, std::size_t end, bool combine) {
    const auto count = static_cast<std::uint32_t>(end) - first;
    if (count == 0) return;
    const Grid& grid = sweep.grid();
    const auto knots = static_cast<int>(sweep.boxes().size());
    const bool join = combine && !ranges.empty() && ranges.back().knots == knots &&
                      ranges.back().lifespan == grid.lifespan &&
                      ranges.back().index_count + count <= kCombinedIndices;
    if (!join) {
        const auto number = static_cast<std::uint32_t>(m_places.size()) - 1;
        ranges.push_back({first, 0, knots, grid.lifespan, number, number, {}, m_boxes.size()});
        m_boxes.resize(m_boxes.size() + static_cast<std::size_t>(knots));
    }
    Range& range = ranges.back();
    range.index_count += count;
    range.end_grid = static_cast<std::uint32_t>(m_places.size());
    range.swept = united(range.swept, grid.bounds);
    for (int k = 0; k < knots; ++k) m_boxes[range.first_box + k].add(sweep.boxes()[k]);
}

RasterBounds RasterGeometry::bounds_at(const Range& range, const Projection& projection,
                                       double t) const {
    if (range.knots == 1) return range.swept;
    // What moves linearly between two boxes stays in the box that does the same.
    const double place = t * (range.knots - 1);
    const int segment = std::min(static_cast<int>(place), range.knots - 2);
    const double f = place - segment;
    const Bounds3f &a = m_boxes[range.first_box + segment],
                   &b = m_boxes[range.first_box + segment + 1];
    Bounds3f box;
    box.add(Vec3f(glm::mix(Vec3d(a.lo), Vec3d(b.lo), f)));
    box.add(Vec3f(glm::mix(Vec3d(a.hi), Vec3d(b.hi), f)));
    return raster_bound(projection, box);
}

std::array<float, 2> RasterGeometry::depths(const Range& range) const {
    Bounds3f box;
    for (int k = 0; k < range.knots; ++k) box.add(m_boxes[range.first_box + k]);
    return {box.lo.z, box.hi.z};
}

std::vector<Vec4f> RasterGeometry::radiance(const RasterSeen& seen) const {
    std::vector<Vec4f> colors(m_vertex_grids.size(), Vec4f(0.0f));
    for (std::size_t g = 0; g < m_grids.size(); ++g) {
        if (m_grids[g]->holdout || !seen.ever(g)) continue;
        const std::vector<Vec3f>& radiance = m_grids[g]->radiance;
        GRANITA_CHECK_EQ(radiance.size(), static_cast<std::size_t>(m_grids[g]->vertex_count()));
        for (std::size_t v = 0; v < radiance.size(); ++v)
            colors[m_places[g].vertex + v] = Vec4f(radiance[v], 1.0f);
    }
    return colors;
}

std::vector<Vec4f> RasterGeometry::opacity() const {
    std::vector<Vec4f> values(m_vertex_grids.size(), Vec4f(1.0f));
    for (std::size_t g = 0; g < m_grids.size(); ++g)
        for (std::size_t v = 0; v < m_grids[g]->opacity.size(); ++v)
            values[m_places[g].vertex + v] =
                Vec4f(m_grids[g]->opacity[v], m_grids[g]->holdout ? 1.0f : 0.0f);
    return values;
}

RasterGeometry::Place RasterGeometry::locate(std::uint32_t vertex) const {
    const std::uint32_t grid = m_vertex_grids.at(vertex);
    const auto local = static_cast<int>(vertex - m_places[grid].vertex);
    return {m_inputs[grid], m_grids[grid]->micropolygon_at(local)};
}

}  // namespace granita
