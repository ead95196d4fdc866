// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/vertex_offsets.h"

#include "base/parallel.h"
#include "dice/opened_mesh.h"
#include "geometry/patch_borders.h"

namespace granita {
namespace {

/// Vertices in a piece of a loop.
constexpr std::size_t kGrain = 1 << 12;

}  // namespace

VertexOffsets::VertexOffsets(const OpenedMesh& mesh, const std::vector<bool>& wanted)
    : m_offsets(wanted.size(), Vec3f(0.0f)) {
    const PatchBorders& borders = mesh.shared().borders();
    parallel_for(wanted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<std::size_t> vertices;
        std::vector<SurfacePlace> places;
        for (std::size_t v = begin; v < end; ++v) {
            if (!wanted[v]) continue;
            vertices.push_back(v);
            places.push_back(borders.vertex(mesh.part().vertex(v)));
        }
        Offsets found;
        mesh.find_offsets(places, false, found);
        for (std::size_t i = 0; i < vertices.size(); ++i) m_offsets[vertices[i]] = found.offset[i];
    });
}

Vec3f VertexOffsets::point(const OpenedMesh& mesh, int knot, std::size_t place) const {
    return mesh.displaced(knot, mesh.points(knot)[place], m_offsets[place]);
}

std::vector<Vec3f> VertexOffsets::points(const OpenedMesh& mesh, int knot) const {
    std::vector<Vec3f> points(m_offsets.size());
    parallel_for(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) points[v] = point(mesh, knot, v);
    });
    return points;
}

}  // namespace granita
