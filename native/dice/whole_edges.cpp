// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/whole_edges.h"

#include <algorithm>
#include <cmath>

#include "dice/opened_mesh.h"
#include "dice/screen_points.h"
#include "geometry/limit_vertices.h"
#include "geometry/subdivision_topology.h"

namespace granita {
namespace {

/// Of a micropolygon's side, as EdgeRate has them: pixels off its chord, the same over its length,
/// and the length below which no bend counts.
constexpr float kSag = 0.03f, kBend = 0.04f, kShortest = 0.15f;

}  // namespace

std::vector<bool> whole_edges(const OpenedMesh& mesh) {
    const SubdivisionTopology& topology = *mesh.shared().subdivision();
    const std::size_t count = topology.edge_count();
    std::vector<bool> whole(count);
    for (std::size_t e = 0; e < count; ++e)
        whole[e] = topology.edge(e).owner.face >= 0 && !topology.edge(e).halved;
    const auto over_edges = [&](auto stays) {
        for (std::size_t e = 0; e < count; ++e)
            if (whole[e])
                whole[e] = stays(static_cast<std::size_t>(topology.edge(e).lo),
                                 static_cast<std::size_t>(topology.edge(e).hi));
    };

    const float longest = mesh.rate().sure_length();
    ScreenPoints screen(mesh);
    for (int k = 0; k < mesh.knot_count(); ++k) {
        const std::span<const Vec3f> points = mesh.points(k);
        screen.project(points);
        over_edges([&](std::size_t a, std::size_t b) {
            const float length2 = mesh.rate().length2(screen[b] - screen[a], points[a], points[b]);
            return length2 <= longest * longest;  // false where not a number
        });
    }
    if (std::ranges::none_of(whole, [](bool w) { return w; })) return whole;
    screen.project(mesh.points(mesh.knots().frame_knot));
    const std::span<const Vec3f> points = mesh.points(mesh.knots().frame_knot);
    const std::vector<Vec3f>& normals = mesh.shared().limit()->normals;
    const Projection& projection = mesh.view().projection;
    const float scale = static_cast<float>(std::max(projection.scale.x, projection.scale.y));
    const auto normal = [&](std::size_t v) {
        return Vec3f(normalize_or(mesh.camera_normal(normals[v]), Vec3d(0.0)));
    };
    over_edges([&](std::size_t a, std::size_t b) {
        if (!screen.met_frame(a) && !screen.met_frame(b)) return false;
        const float nearest = projection.perspective ? std::min(points[a].z, points[b].z) : 1.0f;
        const float pixels = scale / nearest;
        const float height = pixels * chord_height(points[b] - points[a], normal(a), normal(b));
        const float length = glm::distance(screen[a], screen[b]);
        return length <= kShortest || (height <= kSag && height <= kBend * length);
    });
    return whole;
}

}  // namespace granita
