// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/vertex_normals.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/triangulate.h"

namespace granita {
namespace {

/// Unit or zero.
Vec3d direction(const Vec3d& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v * (1.0 / length) : Vec3d(0.0);
}

/// Within 2e-8 (Abramowitz and Stegun, 4.4.46); the C library's took a quarter of the time here.
double arc_cosine(double x) {
    constexpr double kTerms[] = {-0.0012624911, 0.0066700901, -0.0170881256, 0.0308918810,
                                 -0.0501743046, 0.0889789874, -0.2145988016, 1.5707963050};
    const double at = std::min(std::abs(x), 1.0);
    double sum = 0.0;
    for (const double term : kTerms) sum = sum * at + term;
    const double angle = std::sqrt(1.0 - at) * sum;
    return x < 0.0 ? M_PI - angle : angle;
}

/// What a face adds at its corners: its normal by their angles; nothing where it is not finite.
class FaceShares {
  public:
    FaceShares(const GeometryData& data, std::span<const Vec3f> points)
        : m_data(data), m_points(points) {}

    /// `shares` [corners of the face, the first of which is `first`].
    void find(std::size_t first, std::size_t count, Vec3d* shares) {
        const std::int32_t* verts = &m_data.corner_verts[first];
        m_polygon.clear();
        bool finite = true;
        for (std::size_t i = 0; i < count; ++i) {
            m_polygon.push_back(m_points[static_cast<std::size_t>(verts[i])]);
            finite = finite && is_finite(m_polygon.back());
        }
        std::fill_n(shares, count, Vec3d(0.0));
        if (!finite) return;
        m_sides.clear();
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3d way = Vec3d(m_polygon[i + 1 < count ? i + 1 : 0]) - Vec3d(m_polygon[i]);
            m_sides.push_back(direction(way));
        }
        const Vec3d normal = direction(newell_normal(m_polygon));
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3d& back = m_sides[i > 0 ? i - 1 : count - 1];
            shares[i] = arc_cosine(-glm::dot(back, m_sides[i])) * normal;
        }
    }

  private:
    const GeometryData& m_data;
    std::span<const Vec3f> m_points;
    std::vector<Vec3f> m_polygon;
    std::vector<Vec3d> m_sides;  ///< unit; side i leaves corner i
};

/// Faces whose shares are found together, by all threads, and then added one after the other: sums
/// keep their order, and so their bits.  Their shares stay in the cache.
constexpr std::size_t kBlock = 1 << 14, kGrain = 1 << 10;

}  // namespace

std::vector<Vec3f> vertex_normals(const GeometryData& data, std::span<const Vec3f> points) {
    std::vector<Vec3d> sum(points.size(), Vec3d(0.0));
    std::vector<std::size_t> first;  // corner of the block's faces, and the end
    std::vector<Vec3d> shares;       // of the block's corners
    std::size_t corner = 0;
    for (std::size_t face = 0; face < data.face_count(); face += kBlock) {
        const std::size_t count = std::min(kBlock, data.face_count() - face);
        first.assign(1, corner);
        for (std::size_t i = 0; i < count; ++i)
            first.push_back(first.back() + static_cast<std::size_t>(data.face_sizes[face + i]));
        shares.resize(first.back() - corner);
        parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
            FaceShares of_face(data, points);
            for (std::size_t i = begin; i < end; ++i)
                of_face.find(first[i], first[i + 1] - first[i], &shares[first[i] - corner]);
        });
        for (const Vec3d& share : shares)
            sum[static_cast<std::size_t>(data.corner_verts[corner++])] += share;
    }
    std::vector<Vec3f> normals(points.size());
    parallel_for(normals.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) normals[v] = Vec3f(direction(sum[v]));
    });
    return normals;
}

}  // namespace granita
