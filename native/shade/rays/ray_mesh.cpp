// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/ray_mesh.h"

#include <algorithm>

#include "shade/rays/ray_heights.h"

namespace granita {

RayMesh::RayMesh(std::shared_ptr<const SharedGeometry> shared) : RayFaces(std::move(shared)) {
    add_polygons();
    m_primitives.put_still_first();
}

void RayMesh::add_polygons() {
    const GeometryData& data = m_shared->data();
    const auto& patches = m_shared->patches();
    for (int knot = 0; knot < m_primitives.knots; ++knot) {
        const std::span<const Vec3f> vertices =
            m_primitives.knots == 1 ? m_shared->frame_points() : m_shared->knot_points(knot);
        m_primitives.points.insert(m_primitives.points.end(), vertices.begin(), vertices.end());
    }
    m_primitives.indices.reserve(2 * patches.size());
    m_patches.reserve(2 * patches.size());
    for (std::uint32_t k = 0; k < patches.size(); ++k) {
        const BasePatch& patch = patches[k];
        std::array<std::uint32_t, 4> v;
        for (std::size_t i = 0; i < 4; ++i)
            v[i] = static_cast<std::uint32_t>(data.corner_verts[patch.corner[i]]);
        float& extent = m_extents[patch.face];
        for (int knot = 0; knot < m_primitives.knots; ++knot)
            for (const std::uint32_t vertex : v)
                extent = std::max(extent, largest_coordinate(m_primitives.at(knot)[vertex]));
        m_primitives.indices.push_back({v[0], v[1], v[2]});
        m_patches.push_back(2 * k);
        if (patch.kind == PatchKind::Triangle) continue;
        m_primitives.indices.push_back({v[0], v[2], v[3]});
        m_patches.push_back(2 * k + 1);
    }
}

std::string RayMesh::size() const {
    return std::to_string(m_primitives.indices.size()) + " triangles";
}

void RayMesh::locate(std::uint32_t geometry, std::uint32_t triangle, float u, float v,
                     RayHit& hit) const {
    triangle = m_primitives.original(geometry, triangle);
    const std::uint32_t half = m_patches[triangle] & 1u;
    locate_on(m_patches[triangle] / 2, hit);
    if (hit.patch->kind == PatchKind::Triangle)
        hit.uv = {u, v};
    else  // triangles (0, 1, 2) and (0, 2, 3)
        hit.uv = half ? Vec2d(u, u + v) : Vec2d(u + v, v);
}

std::size_t RayMesh::bytes() const {
    return sizeof(*this) + bytes_of_faces() + 4 * m_patches.size();
}

}  // namespace granita
