// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/limit_face.h"

namespace granita {
namespace {

using Point = OpenSubdiv::Bfr::Surface<double>::PointDescriptor;

}  // namespace

void LimitFace::prepare() {
    m_points.assign(static_cast<std::size_t>(m_surface.GetNumPatchPoints()) *
                        static_cast<std::size_t>(m_columns),
                    0.0);
}

bool LimitFace::gather(const SubdivisionTopology& topology, int face,
                       std::span<const Vec3f* const> point_sets) {
    m_columns = 3 * static_cast<int>(point_sets.size());
    if (!topology.factory().InitVertexSurface(face, &m_surface)) return false;
    prepare();
    std::vector<int> index(static_cast<std::size_t>(m_surface.GetNumControlPoints()));
    m_surface.GetControlPointIndices(index.data());
    double* to = m_points.data();
    for (const int vertex : index)
        for (const Vec3f* set : point_sets)
            for (int c = 0; c < 3; ++c) *to++ = static_cast<double>(set[vertex][c]);
    m_surface.ComputePatchPoints(m_points.data(), Point(m_columns));
    return true;
}

bool LimitFace::gather_uv(const SubdivisionTopology& topology, int face, int channel) {
    m_columns = 2;
    if (!topology.factory().InitFaceVaryingSurface(face, &m_surface, channel)) return false;
    prepare();
    std::vector<int> index(static_cast<std::size_t>(m_surface.GetNumControlPoints()));
    m_surface.GetControlPointIndices(index.data());
    const std::vector<float>& values = topology.uv_values(channel);
    double* to = m_points.data();
    for (const int value : index)
        for (std::size_t c = 0; c < 2; ++c)
            *to++ = static_cast<double>(values[2 * static_cast<std::size_t>(value) + c]);
    m_surface.ComputePatchPoints(m_points.data(), Point(m_columns));
    return true;
}

void LimitFace::evaluate(const Vec2d& uv, double* p) const {
    m_surface.Evaluate(&uv.x, m_points.data(), Point(m_columns), p);
}

void LimitFace::evaluate(const Vec2d& uv, double* p, double* du, double* dv) const {
    m_surface.Evaluate(&uv.x, m_points.data(), Point(m_columns), p, du, dv);
}

FaceCoordinates::FaceCoordinates(const SubdivisionTopology& topology, int face)
    : m_parameterization(topology.factory().GetFaceParameterization(face)) {}

Vec2d FaceCoordinates::vertex(int corner) const {
    Vec2d uv;
    m_parameterization.GetVertexCoord(corner, &uv.x);
    return uv;
}

Vec2d FaceCoordinates::edge(int local, double t) const {
    Vec2d uv;
    m_parameterization.GetEdgeCoord(local, t, &uv.x);
    return uv;
}

Vec2d FaceCoordinates::sub_face(int sub, const Vec2d& uv) const {
    if (!m_parameterization.HasSubFaces()) return uv;
    Vec2d face;
    m_parameterization.ConvertNormalizedSubFaceToCoord(sub, &uv.x, &face.x);
    return face;
}

}  // namespace granita
