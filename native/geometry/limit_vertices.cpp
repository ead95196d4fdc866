// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/limit_vertices.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/limit_face.h"
#include "geometry/shared_geometry.h"
#include "geometry/subdivision_topology.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Faces that a thread takes at a time.
constexpr std::size_t kGrain = 1024;

/// Sine between derivatives that are taken for parallel: rounded corners of a sheet, or edges of no
/// length.
constexpr double kParallel = 1e-6;

Vec3d set(const std::vector<double>& columns, std::size_t k) {
    return {columns[3 * k], columns[3 * k + 1], columns[3 * k + 2]};
}

/// Zero where there is none.
Vec3f normal(const Vec3d& du, const Vec3d& dv) {
    const Vec3d across = glm::cross(du, dv);
    const double length = glm::length(across);
    const bool parallel = !(length > kParallel * glm::length(du) * glm::length(dv));
    return parallel ? Vec3f(0.0f) : Vec3f(across / length);
}

class VertexFinder {
  public:
    explicit VertexFinder(const SharedGeometry& geometry)
        : m_geometry(geometry),
          m_topology(*geometry.subdivision()),
          m_vertex_count(geometry.data().vertex_count()),
          m_knots(geometry.is_static() ? 1 : static_cast<std::size_t>(geometry.data().knots)),
          m_normals(m_knots * m_vertex_count, Vec3f(0.0f)) {
        for (std::size_t k = 0; k < m_knots; ++k) {
            const std::span<const Vec3f> cage = geometry.knot_points(static_cast<int>(k));
            m_sets.push_back(cage.data());
            m_found.points.insert(m_found.points.end(), cage.begin(), cage.end());
        }
    }

    LimitVertices find() {
        const std::size_t count = m_geometry.data().face_count();
        parallel_for(count, kGrain,
                     [&](std::size_t begin, std::size_t end) { find_points(begin, end); });
        m_found.heights.resize(count);
        parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t face = begin; face != end; ++face)
                for (std::size_t k = 0; k < m_knots; ++k)
                    m_found.heights[face] = std::max(m_found.heights[face], height(face, k));
        });
        find_frame_normals();
        return std::move(m_found);
    }

  private:
    std::size_t vertex(std::size_t face, int corner) const {
        return static_cast<std::size_t>(
            m_geometry.data()
                .corner_verts[m_geometry.first_corner(face) + static_cast<std::uint32_t>(corner)]);
    }

    /// Each vertex by the face that owns it (subdivision_topology.h).
    void find_points(std::size_t begin, std::size_t end) {
        LimitFace limit;
        std::vector<double> p(3 * m_knots), du(3 * m_knots), dv(3 * m_knots);
        for (std::size_t face = begin; face != end; ++face) {
            bool gathered = false;
            for (int corner = 0; corner < m_geometry.data().face_sizes[face]; ++corner) {
                const std::size_t v = vertex(face, corner);
                const SubdivisionTopology::Owner& owner = m_topology.vertex_owner(v);
                if (owner.face != static_cast<int>(face) || owner.local != corner) continue;
                if (!gathered && !limit.gather(m_topology, owner.face, m_sets)) break;
                gathered = true;
                const FaceCoordinates coordinates(m_topology, owner.face);
                limit.evaluate(coordinates.vertex(corner), p.data(), du.data(), dv.data());
                for (std::size_t k = 0; k < m_knots; ++k) {
                    m_found.points[k * m_vertex_count + v] = Vec3f(set(p, k));
                    m_normals[k * m_vertex_count + v] = normal(set(du, k), set(dv, k));
                }
                if (m_normals[v] != Vec3f(0.0f)) continue;
                // From inside of the face.
                limit.evaluate(coordinates.sub_face(corner, Vec2d(0.25)), p.data(), du.data(),
                               dv.data());
                for (std::size_t k = 0; k < m_knots; ++k)
                    m_normals[k * m_vertex_count + v] = normal(set(du, k), set(dv, k));
            }
        }
    }

    /// Bends along u and v add up in the middle of a face; a quad's diagonal misses a quarter of
    /// its twist.
    float height(std::size_t face, std::size_t knot) const {
        const Vec3f* const p = &m_found.points[knot * m_vertex_count];
        const Vec3f* const normal = &m_normals[knot * m_vertex_count];
        const int n = m_geometry.data().face_sizes[face];
        float along[2] = {0.0f, 0.0f};  // u and v in turns around the face
        for (int i = 0; i < n; ++i) {
            const std::size_t a = vertex(face, i), b = vertex(face, (i + 1) % n);
            along[i % 2] = std::max(along[i % 2], chord_height(p[b] - p[a], normal[a], normal[b]));
        }
        float twist = 0.0f;
        if (n == 4) {
            const std::size_t a = vertex(face, 0), b = vertex(face, 1), c = vertex(face, 2),
                              d = vertex(face, 3);
            const Vec3f across(normalize_or(glm::cross(p[c] - p[a], p[d] - p[b]), Vec3f(0.0f)));
            twist = 0.25f * std::abs(glm::dot(p[a] - p[b] + p[c] - p[d], across));
        }
        return along[0] + along[1] + twist;
    }

    void find_frame_normals() {
        const KnotTime& frame = m_geometry.frame();
        m_found.normals.assign(
            m_normals.begin() + static_cast<std::ptrdiff_t>(frame.knot * m_vertex_count),
            m_normals.begin() + static_cast<std::ptrdiff_t>((frame.knot + 1) * m_vertex_count));
        if (frame.fraction == 0.0) return;
        const Vec3f* const next = &m_normals[(frame.knot + 1) * m_vertex_count];
        const auto t = static_cast<float>(frame.fraction);
        for (std::size_t v = 0; v < m_vertex_count; ++v) {
            Vec3f& normal = m_found.normals[v];
            normal = normalize_or(normal * (1.0f - t) + next[v] * t, normal);
        }
    }

    const SharedGeometry& m_geometry;
    const SubdivisionTopology& m_topology;
    const std::size_t m_vertex_count, m_knots;
    std::vector<const Vec3f*> m_sets;
    std::vector<Vec3f> m_normals;  ///< [knots][V]
    LimitVertices m_found;
};

}  // namespace

LimitVertices limit_vertices(const SharedGeometry& geometry) {
    return VertexFinder(geometry).find();
}

}  // namespace granita
