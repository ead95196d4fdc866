// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_displaced.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "geometry/subdivision_topology.h"
#include "geometry/surface_frames.h"
#include "shade/rays/ray_heights.h"

namespace granita {
namespace {

/// Pixels along a cell: what is finer casts no shadow of its own.  Against the same waves modelled
/// (16 pixels long, 6 high, a low sun) cells of two pixels move the edges of shadows by half a
/// pixel.
constexpr float kCell = 1.0f;
/// log2 of the cells along a patch's side.
constexpr int kMostLevels = 10;
/// To the nearest power of two.
constexpr double kRounding = 1.41421356;
/// Cells of a geometry, whatever the camera sees of it: for its shadow's sake.
constexpr std::size_t kLeastCells = 1 << 14;
/// Levels that a patch gets for that alone.
constexpr int kMostUnseenLevels = 6;
/// Points over all knots that a geometry may have: about a gigabyte in Embree.
constexpr std::size_t kMostPoints = 8'000'000;
/// Points that are displaced at once.
constexpr std::size_t kRun = 1024;
/// Patches that a thread takes at a time.
constexpr std::size_t kGrain = 256;

/// (i, j) of a lattice's cells; a triangle's have i + j <= cells.
class Cells {
  public:
    Cells(PatchKind kind, int n_u, int n_v)
        : m_triangle(kind == PatchKind::Triangle), m_cells(n_u), m_rows(n_v) {}

    std::uint32_t index(int i, int j) const {
        // Rows of a triangle get shorter by one each.
        const int before = m_triangle ? j * (m_cells + 1) - j * (j - 1) / 2 : j * (m_cells + 1);
        return static_cast<std::uint32_t>(before + i);
    }
    template <class Act>
    void for_points(Act act) const {
        for (int j = 0; j <= m_rows; ++j)
            for (int i = 0; i <= (m_triangle ? m_cells - j : m_cells); ++i) act(i, j);
    }
    /// Each with its corners (i, j) as Embree takes them, which cuts a quad between its second and
    /// its fourth: along the crease as pairs of triangles are, in a triangle along its own third
    /// side, where cells are halves.
    template <class Act>
    void for_quads(Act act) const {
        using Corner = std::array<int, 2>;
        for (int j = 0; j < m_rows; ++j)
            for (int i = 0; i < (m_triangle ? m_cells - j : m_cells); ++i) {
                const Corner a{i, j}, b{i + 1, j}, c{i + 1, j + 1}, d{i, j + 1};
                if (m_triangle)
                    act(a, b, i + j + 1 < m_cells ? c : d, d);
                else
                    act(b, c, d, a);
            }
    }
    /// Where step i of a side is, sides running around the patch.
    std::array<int, 2> on_side(int side, int i) const {
        const int n = m_cells;
        if (m_triangle)
            return side == 0   ? std::array{i, 0}
                   : side == 1 ? std::array{n - i, i}
                               : std::array{0, n - i};
        switch (side) {
            case 0:
                return {i, 0};
            case 1:
                return {n, i};
            case 2:
                return {n - i, m_rows};
            default:
                return {0, m_rows - i};
        }
    }

  private:
    bool m_triangle;
    int m_cells, m_rows;
};

}  // namespace

RayDisplaced::RayDisplaced(std::shared_ptr<const SharedGeometry> shared,
                           const Displacement& displacement, std::size_t instance,
                           const RayDetail& detail, const Progress& progress)
    : RayFaces(std::move(shared)), m_borders(m_shared->borders()) {
    find_levels(detail);
    coarsen();
    find_edge_levels();
    number();
    place_vertices(displacement, instance, progress);
    const std::size_t patches = m_shared->patches().size();
    parallel_for(patches, kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<SurfacePlace> places;
        std::size_t first_point = m_first_point[begin];
        for (std::size_t k = begin; k != end; ++k) {
            make_quads(k);
            if (point_count(k) > 0) add_places(k, places);
            if (places.size() < kRun && k + 1 != end) continue;
            progress.check();
            place(
                places, [&](std::size_t i) { return first_point + i; }, displacement, instance);
            first_point += places.size();
            places.clear();
        }
    });
    std::vector<float> extents(patches, 0.0f);
    parallel_for(patches, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            for (int knot = 0; knot < m_primitives.knots; ++knot)
                for (std::size_t quad = m_first_quad[k]; quad < m_first_quad[k + 1]; ++quad)
                    for (const std::uint32_t corner : m_primitives.indices[quad])
                        extents[k] =
                            std::max(extents[k], largest_coordinate(m_primitives.at(knot)[corner]));
    });
    for (std::size_t k = 0; k < patches; ++k) {
        float& extent = m_extents[m_shared->patches()[k].face];
        extent = std::max(extent, extents[k]);
    }
    m_primitives.put_still_first();
}

void RayDisplaced::find_levels(const RayDetail& detail) {
    const auto& patches = m_shared->patches();
    m_levels.assign(patches.size(), {});
    int unseen = 0;
    while (unseen < kMostUnseenLevels && patches.size() << (2 * unseen) < kLeastCells) ++unseen;
    parallel_for(patches.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        SurfaceFrames frames;
        for (std::size_t k = begin; k != end; ++k) {
            static const std::vector<Vec2d> quad = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}};
            static const std::vector<Vec2d> triangle = {{0, 0}, {1, 0}, {0, 1}, {1 / 3., 1 / 3.}};
            find_frames(*m_shared, patches[k],
                        patches[k].kind == PatchKind::Triangle ? triangle : quad, m_shared->frame(),
                        frames);
            float pixel = std::numeric_limits<float>::infinity();
            double length_u = 0.0, length_v = 0.0;
            for (std::size_t i = 0; i < frames.p.size(); ++i) {
                pixel = std::min(pixel, detail.pixel(Vec3f(frames.p[i])));
                length_u = std::max(length_u, glm::length(frames.su[i]));
                length_v = std::max(length_v, glm::length(frames.sv[i]));
            }
            if (patches[k].kind == PatchKind::Triangle)
                length_u = length_v = std::max(length_u, length_v);
            const auto level = [&](double length) {
                int found = 0;
                while (found < kMostLevels &&
                       length > kRounding * static_cast<double>(kCell * pixel) * (1 << found))
                    ++found;
                return static_cast<std::uint8_t>(std::max(found, unseen));
            };
            m_levels[k] = {level(length_u), level(length_v)};
        }
    });
}

void RayDisplaced::coarsen() {
    const auto& patches = m_shared->patches();
    const auto points = [&] {
        std::size_t sum = 0;
        for (std::size_t k = 0; k < patches.size(); ++k) sum += point_count(k);
        if (std::ranges::any_of(m_levels, [](const Levels& l) { return l.are_none(); }))
            sum += m_shared->data().vertex_count();
        return sum * static_cast<std::size_t>(m_primitives.knots);
    };
    const auto can_be_coarser = [](const Levels& level) { return level.u > 0 || level.v > 0; };
    while (points() > kMostPoints && std::ranges::any_of(m_levels, can_be_coarser)) {
        m_coarsened = true;
        for (Levels& level : m_levels) {
            level.u -= level.u > 0 ? 1 : 0;
            level.v -= level.v > 0 ? 1 : 0;
        }
    }
    // Sub-faces meet in the middle of an edge, which then is a point of both sides.
    const SubdivisionTopology* topology = m_shared->subdivision();
    for (std::size_t k = 0; topology && k < patches.size(); ++k)
        for (int i = 0; patches[k].kind == PatchKind::Quad && i < 4; ++i)
            if (topology->edge(topology->face_edge(patches[k].face, i)).halved)
                m_levels[k] = {std::max<std::uint8_t>(m_levels[k].u, 1),
                               std::max<std::uint8_t>(m_levels[k].v, 1)};
}

int RayDisplaced::edge_level(const PatchBorders::Side& side, int level) const {
    return std::abs(side.to - side.from) < 1.0 ? level + 1 : level;
}

void RayDisplaced::find_edge_levels() {
    m_edge_levels.assign(m_borders.edge_count(), kMostLevels + 1);
    const auto& patches = m_shared->patches();
    for (std::size_t k = 0; k < patches.size(); ++k)
        for (int i = 0; i < PatchBorders::side_count(patches[k].kind); ++i) {
            const PatchBorders::Side side = m_borders.side(k, i);
            std::uint8_t& level = m_edge_levels[side.edge];
            level =
                std::min(level, static_cast<std::uint8_t>(edge_level(side, m_levels[k].along(i))));
        }
}

bool RayDisplaced::is_of_vertices(std::size_t k) const {
    return m_levels[k].are_none() && m_shared->patches()[k].kind != PatchKind::SubFace;
}

std::size_t RayDisplaced::point_count(std::size_t k) const {
    if (is_of_vertices(k)) return 0;
    const std::size_t n = (std::size_t{1} << m_levels[k].u) + 1;
    if (m_shared->patches()[k].kind == PatchKind::Triangle) return n * (n + 1) / 2;
    return n * ((std::size_t{1} << m_levels[k].v) + 1);
}

std::size_t RayDisplaced::quad_count(std::size_t k) const {
    const std::size_t n = std::size_t{1} << m_levels[k].u;
    if (m_shared->patches()[k].kind == PatchKind::Triangle) return n * (n + 1) / 2;
    return n << m_levels[k].v;
}

void RayDisplaced::number() {
    const auto& patches = m_shared->patches();
    std::size_t points = 0, quads = 0;
    for (std::size_t k = 0; k < patches.size() && points == 0; ++k)
        if (is_of_vertices(k)) points = m_shared->data().vertex_count();
    for (std::size_t k = 0; k < patches.size(); ++k) {
        m_first_point.push_back(static_cast<std::uint32_t>(points));
        m_first_quad.push_back(static_cast<std::uint32_t>(quads));
        points += point_count(k);
        quads += quad_count(k);
    }
    m_first_quad.push_back(static_cast<std::uint32_t>(quads));
    m_primitives.points.resize(points * static_cast<std::size_t>(m_primitives.knots));
    m_primitives.indices.resize(quads);
}

/// The nearest of the points that the edge has.
SurfacePlace RayDisplaced::border_place(const PatchBorders::Side& side, int i, int cells) const {
    const double t = side.from + (side.to - side.from) * i / cells;
    const double steps = 1 << m_edge_levels[side.edge];
    return m_borders.place(side.edge, std::floor(t * steps + 0.5) / steps);
}

/// Adds the places of a patch's points.
void RayDisplaced::add_places(std::size_t k, std::vector<SurfacePlace>& places) const {
    const BasePatch& patch = m_shared->patches()[k];
    const int n_u = 1 << m_levels[k].u, n_v = 1 << m_levels[k].v;
    const Cells cells(patch.kind, n_u, n_v);
    const std::size_t first = places.size();
    places.resize(first + point_count(k));
    const auto at = [&](int i, int j) -> SurfacePlace& {
        return places[first + cells.index(i, j)];
    };
    cells.for_points([&](int i, int j) { at(i, j) = {&patch, Vec2d(i, j) / Vec2d(n_u, n_v)}; });
    for (int number = 0; number < PatchBorders::side_count(patch.kind); ++number) {
        const PatchBorders::Side side = m_borders.side(k, number);
        const int n = 1 << m_levels[k].along(number);
        for (int i = 0; i <= n; ++i) {
            const auto [u, v] = cells.on_side(number, i);
            at(u, v) = border_place(side, i, n);
        }
    }
}

/// Those of patches that have no other points, each once.
void RayDisplaced::place_vertices(const Displacement& displacement, std::size_t instance,
                                  const Progress& progress) {
    const auto& patches = m_shared->patches();
    std::vector<bool> wanted;
    for (std::size_t k = 0; k < patches.size(); ++k) {
        if (!is_of_vertices(k)) continue;
        wanted.resize(m_shared->data().vertex_count(), false);
        for (const std::uint32_t corner : patches[k].corner) wanted[vertex_of(corner)] = true;
    }
    parallel_for(wanted.size(), kRun, [&](std::size_t begin, std::size_t end) {
        progress.check();
        std::vector<SurfacePlace> places;
        std::vector<std::uint32_t> vertices;
        for (std::size_t v = begin; v < end; ++v) {
            if (!wanted[v]) continue;
            places.push_back(m_borders.vertex(v));
            vertices.push_back(static_cast<std::uint32_t>(v));
        }
        place(
            places, [&](std::size_t i) { return vertices[i]; }, displacement, instance);
    });
}

/// `point(i)`: which of the points is the i-th place.
template <class Point>
void RayDisplaced::place(std::span<const SurfacePlace> places, const Point& point,
                         const Displacement& displacement, std::size_t instance) {
    const std::size_t total = m_primitives.point_count();
    const auto knots = static_cast<std::size_t>(m_primitives.knots);
    parallel_for(places.size(), kRun, [&](std::size_t begin, std::size_t end) {
        const std::span<const SurfacePlace> of = places.subspan(begin, end - begin);
        std::vector<Vec2d> uv;
        std::vector<Vec3f> positions;
        Offsets offsets;
        displacement.find(instance, *m_shared, of, false, offsets);
        for_each_patch(of, [&](const BasePatch& patch, std::size_t first, std::size_t count) {
            uv.clear();
            for (const SurfacePlace& at : of.subspan(first, count)) uv.push_back(at.uv);
            find_positions(*m_shared, patch, uv, positions);
            for (std::size_t knot = 0; knot < knots; ++knot)
                for (std::size_t i = 0; i < count; ++i)
                    m_primitives.points[knot * total + point(begin + first + i)] =
                        positions[knot * count + i] + offsets.offset[first + i];
        });
    });
}

void RayDisplaced::make_quads(std::size_t k) {
    const Cells cells(m_shared->patches()[k].kind, 1 << m_levels[k].u, 1 << m_levels[k].v);
    std::size_t quad = m_first_quad[k];
    const BasePatch& patch = m_shared->patches()[k];
    const bool of_vertices = is_of_vertices(k);
    const auto number_of = [&](const std::array<int, 2>& at) {
        if (!of_vertices) return m_first_point[k] + cells.index(at[0], at[1]);
        // (1, 1) of a quad is its third corner, (0, 1) its fourth, or a triangle's third.
        const int corner = at[1] == 0 ? at[0] : 3 - at[0];
        return vertex_of(patch.corner[corner]);
    };
    cells.for_quads(
        [&](const auto&... corners) { m_primitives.indices[quad++] = {number_of(corners)...}; });
}

std::string RayDisplaced::size() const {
    return std::to_string(m_first_quad.back()) + " quads, displaced";
}

void RayDisplaced::locate(std::uint32_t geometry, std::uint32_t quad, float u, float v,
                          RayHit& hit) const {
    quad = m_primitives.original(geometry, quad);
    const auto after = std::ranges::upper_bound(m_first_quad, quad);
    const auto k = static_cast<std::size_t>(after - m_first_quad.begin()) - 1;
    locate_on(k, hit);
    const int n = 1 << m_levels[k].u;
    const Vec2d steps(n, 1 << m_levels[k].v);
    int cell = static_cast<int>(quad - m_first_quad[k]), row = 0;
    if (hit.patch->kind != PatchKind::Triangle) {
        // Embree's corners are the cell's second, third, fourth and first.
        hit.uv = (Vec2d(cell % n, cell / n) + Vec2d(1.0 - v, u)) / steps;
        return;
    }
    for (; cell >= n - row; ++row) cell -= n - row;
    hit.uv = (Vec2d(cell, row) + Vec2d(u, v)) / steps;
}

std::size_t RayDisplaced::bytes() const {
    return sizeof(*this) + bytes_of_faces() + sizeof(Levels) * m_levels.size() +
           m_edge_levels.size() + 4 * (m_first_point.size() + m_first_quad.size());
}

}  // namespace granita
