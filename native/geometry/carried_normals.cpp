// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/carried_normals.h"

#include <algorithm>

#include "base/parallel.h"
#include "geometry/anchor.h"
#include "geometry/shared_geometry.h"
#include "geometry/triangulate.h"
#include "math/angle_between.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Cosine of what is one normal but for how files store it (Blender's own take 16 bits).
constexpr float kSame = 1.0f - 1e-6f;
/// Normals of a vertex that a corner is compared with; fans of flat faces have as many as faces.
constexpr int kMostCompared = 16;
constexpr std::size_t kGrain = 1 << 10;

/// What a face adds at its corners where it is elsewhere: their normals as they go along, by their
/// angles there.
class CarriedShares {
  public:
    CarriedShares(const GeometryData& data, std::span<const Vec3f> from, std::span<const Vec3f> to)
        : m_data(data), m_from(from), m_to(to) {}

    /// `shares` [corners of the face, the first of which is `first`].
    void find(std::size_t first, std::size_t count, Vec3d* shares) {
        std::fill_n(shares, count, Vec3d(0.0));
        m_from.take(m_data, first, count);
        m_to.take(m_data, first, count);
        if (!m_from.finite || !m_to.finite) return;
        for (std::size_t i = 0; i < count; ++i) {
            const Anchor before = m_from.anchor(i), after = m_to.anchor(i);
            // At a vertex amid an edge sides tell no turn: one of them and the whole face do.
            const bool sound = before.is_sound() && after.is_sound();
            const Mat3f turn =
                sound ? carried(before, after) : carried(m_from.beside(before), m_to.beside(after));
            const Vec3f normal =
                glm::transpose(glm::inverse(turn)) * m_data.corner_normals[first + i];
            const float angle = angle_between(normalize_or(after.along, Vec3f(0.0f)),
                                              normalize_or(after.across, Vec3f(0.0f)));
            const Vec3d share =
                Vec3d(normalize_or(normal, Vec3f(0.0f))) * static_cast<double>(angle);
            if (is_finite(Vec3f(share))) shares[i] = share;
        }
    }

  private:
    struct Face {
        explicit Face(std::span<const Vec3f> of_vertices) : points(of_vertices) {}

        void take(const GeometryData& data, std::size_t first, std::size_t count) {
            polygon.clear();
            finite = true;
            for (std::size_t i = 0; i < count; ++i) {
                polygon.push_back(points[static_cast<std::size_t>(data.corner_verts[first + i])]);
                finite = finite && is_finite(polygon.back());
            }
            across = newell_normal(polygon);
        }
        Anchor anchor(std::size_t i) const {
            const std::size_t n = polygon.size();
            return {polygon[i], polygon[(i + 1) % n] - polygon[i],
                    polygon[(i + n - 1) % n] - polygon[i]};
        }
        /// By the side that leaves, or, where that has no length, the other one.
        Anchor beside(const Anchor& corner) const {
            const Vec3f side = glm::length(corner.along) > 0.0f ? corner.along : -corner.across;
            const Vec3f out = normalize_or(Vec3f(across), Vec3f(0.0f));
            return {corner.place, side, glm::cross(out, side)};
        }

        std::span<const Vec3f> points;
        std::vector<Vec3f> polygon;
        Vec3d across{0.0};
        bool finite = true;
    };

    const GeometryData& m_data;
    Face m_from, m_to;
};

}  // namespace

CarriedNormals::CarriedNormals(const SharedGeometry& geometry) : m_geometry(geometry) {
    find_groups();
}

void CarriedNormals::find_groups() {
    const GeometryData& data = m_geometry.data();
    const std::vector<Vec3f>& normals = data.corner_normals;
    constexpr std::uint32_t kNone = 0xffffffff;
    std::vector<std::uint32_t> last(data.vertex_count(), kNone);  // group of a vertex
    std::vector<std::uint32_t> before, corner_of;                 // [groups] of the same vertex
    m_group.reserve(normals.size());
    for (std::size_t face = 0; face < data.face_count(); ++face) {
        const bool flat = !data.smooth.empty() && data.smooth[face] == 0;
        for (int i = 0; i < data.face_sizes[face]; ++i) {
            const auto corner = static_cast<std::uint32_t>(m_group.size());
            auto& newest = last[static_cast<std::size_t>(data.corner_verts[corner])];
            std::uint32_t found = flat ? kNone : newest;
            for (int n = 0; found != kNone; ++n, found = before[found]) {
                if (n == kMostCompared) found = kNone;
                if (found == kNone || glm::dot(normals[corner_of[found]], normals[corner]) > kSame)
                    break;
            }
            if (found == kNone) {
                found = m_group_count++;
                corner_of.push_back(corner);
                before.push_back(flat ? kNone : newest);
                if (!flat) newest = found;  // no other corner may join a flat face's
            }
            m_group.push_back(found);
        }
    }
}

std::vector<Vec3f> CarriedNormals::at(std::span<const Vec3f> points) const {
    const GeometryData& data = m_geometry.data();
    std::vector<Vec3d> shares(m_group.size());
    parallel_for(data.face_count(), kGrain, [&](std::size_t begin, std::size_t end) {
        CarriedShares of_face(data, m_geometry.frame_points(), points);
        for (std::size_t face = begin; face < end; ++face) {
            const std::uint32_t first = m_geometry.first_corner(face);
            of_face.find(first, static_cast<std::size_t>(data.face_sizes[face]), &shares[first]);
        }
    });
    // One after the other: sums keep their order, and so their bits.
    std::vector<Vec3d> sums(m_group_count, Vec3d(0.0));
    for (std::size_t corner = 0; corner < shares.size(); ++corner)
        sums[m_group[corner]] += shares[corner];
    std::vector<Vec3f> normals;
    normals.reserve(sums.size());
    for (const Vec3d& sum : sums) normals.emplace_back(normalize_or(sum, Vec3d(0.0)));
    return normals;
}

}  // namespace granita
