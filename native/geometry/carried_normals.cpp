// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/carried_normals.h"

#include <cmath>

#include "base/parallel.h"
#include "geometry/anchor.h"
#include "geometry/shared_geometry.h"
#include "math/angle_between.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Cosine of what is one normal but for how files store it (Blender's own take 16 bits).
constexpr float kSame = 1.0f - 1e-6f;
/// Normals of a vertex that a corner is compared with; fans of flat faces have as many as faces.
constexpr std::size_t kMostCompared = 16;
constexpr std::size_t kGrain = 1 << 10;

Anchor corner_anchor(const Vec3f& before, const Vec3f& at, const Vec3f& after) {
    return {at, after - at, before - at};
}

}  // namespace

CarriedNormals::CarriedNormals(const SharedGeometry& geometry) : m_geometry(geometry) {
    find_groups();
}

void CarriedNormals::find_groups() {
    const GeometryData& data = m_geometry.data();
    const std::vector<Vec3f>& normals = data.corner_normals;
    std::vector<std::vector<std::uint32_t>> first_of;  // [V] a corner of each of its groups
    first_of.resize(data.vertex_count());
    m_group.resize(normals.size());
    for (std::uint32_t corner = 0; corner < normals.size(); ++corner) {
        auto& groups = first_of[static_cast<std::size_t>(data.corner_verts[corner])];
        std::uint32_t found = m_group_count;
        for (std::size_t i = 0; i < std::min(groups.size(), kMostCompared); ++i)
            if (glm::dot(normals[groups[i]], normals[corner]) > kSame) found = m_group[groups[i]];
        m_group[corner] = found;
        if (found != m_group_count) continue;
        groups.push_back(corner);
        ++m_group_count;
    }
}

Vec3d CarriedNormals::share(std::span<const Vec3f> points, std::uint32_t before,
                            std::uint32_t corner, std::uint32_t after) const {
    const GeometryData& data = m_geometry.data();
    const auto anchor_in = [&](std::span<const Vec3f> of) {
        const auto at = [&](std::uint32_t c) {
            return of[static_cast<std::size_t>(data.corner_verts[c])];
        };
        return corner_anchor(at(before), at(corner), at(after));
    };
    const Anchor then = anchor_in(points);
    const Mat3f turn = carried(anchor_in(m_geometry.frame_points()), then);
    const Vec3f normal =
        normalize_or(glm::transpose(glm::inverse(turn)) * data.corner_normals[corner], Vec3f(0.0f));
    const float angle = angle_between(normalize_or(then.along, Vec3f(0.0f)),
                                      normalize_or(then.across, Vec3f(0.0f)));
    const Vec3d weighed = Vec3d(normal) * static_cast<double>(angle);
    return std::isfinite(glm::dot(weighed, weighed)) ? weighed : Vec3d(0.0);
}

std::vector<Vec3f> CarriedNormals::at(std::span<const Vec3f> points) const {
    const GeometryData& data = m_geometry.data();
    std::vector<Vec3d> shares(m_group.size());
    parallel_for(data.face_count(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t face = begin; face < end; ++face) {
            const std::uint32_t first = m_geometry.first_corner(face);
            const auto n = static_cast<std::uint32_t>(data.face_sizes[face]);
            for (std::uint32_t i = 0; i < n; ++i)
                shares[first + i] =
                    share(points, first + (i + n - 1) % n, first + i, first + (i + 1) % n);
        }
    });
    // One after the other: sums keep their order, and so their bits.
    std::vector<Vec3d> sums(m_group_count, Vec3d(0.0));
    for (std::size_t corner = 0; corner < shares.size(); ++corner)
        sums[m_group[corner]] += shares[corner];
    for (Vec3d& sum : sums) sum = normalize_or(sum, Vec3d(0.0));
    std::vector<Vec3f> normals;
    normals.reserve(m_group.size());
    for (const std::uint32_t group : m_group) normals.emplace_back(sums[group]);
    return normals;
}

}  // namespace granita
