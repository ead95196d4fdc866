// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/polygon_patches.h"

#include <algorithm>
#include <cmath>

#include "geometry/triangulate.h"

namespace granita {
namespace {

/// Of the angle between the two triangles of a pair that is not bent, 8 degrees, as within a
/// cluster of FaceBatch: what one micropolygon blurs across the crease, a pixel wide, is then off
/// by .25 % where light falls straight down.
constexpr double kLeastCosine = 0.99;

BasePatch triangle(std::uint32_t face, std::uint32_t sub, std::uint32_t a, std::uint32_t b,
                   std::uint32_t c) {
    BasePatch patch;
    patch.face = face;
    patch.sub = sub;
    patch.corner[0] = a;
    patch.corner[1] = b;
    patch.corner[2] = patch.corner[3] = c;
    patch.kind = PatchKind::Triangle;
    patch.whole_face = false;
    return patch;
}

}  // namespace

BasePatch BasePatch::half(int number) const {
    const auto sub_patch = static_cast<std::uint32_t>(number);
    return triangle(face, sub_patch, corner[0], corner[1 + number], corner[2 + number]);
}

void PolygonPatches::add(std::uint32_t face, std::vector<BasePatch>& patches) {
    const std::uint32_t first = m_first_corner[face];
    switch (m_data->face_sizes[face]) {
        case 3:
            patches.push_back(triangle(face, 0, first, first + 1, first + 2));
            patches.back().whole_face = true;
            return;
        case 4:
            return add_quad(face, patches);
        default:
            add_ngon(face, patches);
            skip(face);
    }
}

void PolygonPatches::skip(std::uint32_t face) {
    const std::int32_t n = m_data->face_sizes[face];
    if (n > 4) m_ngon_corner += 3 * static_cast<std::size_t>(n - 2);
}

void PolygonPatches::add_quad(std::uint32_t face, std::vector<BasePatch>& patches) const {
    const std::uint32_t first = m_first_corner[face];
    const Vec3f quad[4] = {point(first), point(first + 1), point(first + 2), point(first + 3)};
    const QuadTriangles triangles = triangulate_quad(quad, m_data->quads_by_normal);
    const auto corner = [&](int i) {
        return first + static_cast<std::uint32_t>((triangles.start + i) % 4);
    };
    BasePatch& patch = patches.emplace_back();
    patch.face = face;
    patch.kind = PatchKind::TrianglePair;
    patch.bent = triangles.cosine < kLeastCosine;
    for (int i = 0; i < 4; ++i) patch.corner[i] = corner(i);
}

void PolygonPatches::add_ngon(std::uint32_t face, std::vector<BasePatch>& patches) {
    const std::uint32_t first = m_first_corner[face];
    const auto n = static_cast<std::uint32_t>(m_data->face_sizes[face]);
    if (!m_data->ngon_triangles.empty()) {
        const std::int32_t* corner = &m_data->ngon_triangles[m_ngon_corner];
        for (std::uint32_t sub = 0; sub + 2 < n; ++sub, corner += 3)
            patches.push_back(triangle(face, sub, first + static_cast<std::uint32_t>(corner[0]),
                                       first + static_cast<std::uint32_t>(corner[1]),
                                       first + static_cast<std::uint32_t>(corner[2])));
        return;
    }
    std::vector<Vec3f> polygon;
    for (std::uint32_t i = 0; i < n; ++i) polygon.push_back(point(first + i));
    const Triangulation triangulation = triangulate(polygon);
    if (!triangulation.simple) ++m_crossed;
    std::uint32_t sub = 0;
    for (const std::array<int, 3>& t : triangulation.triangles)
        patches.push_back(triangle(face, sub++, first + static_cast<std::uint32_t>(t[0]),
                                   first + static_cast<std::uint32_t>(t[1]),
                                   first + static_cast<std::uint32_t>(t[2])));
}

}  // namespace granita
