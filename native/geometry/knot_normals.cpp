// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/knot_normals.h"

#include "geometry/carried_normals.h"
#include "geometry/shared_geometry.h"
#include "geometry/vertex_normals.h"

namespace granita {

KnotTime NormalTimes::at(KnotTime t) const {
    if (frame_is_knot() || t.knot < frame.knot) return t;
    if (t.knot > frame.knot) return {t.knot + 1, t.fraction};
    if (t.fraction < frame.fraction) return {t.knot, t.fraction / frame.fraction};
    return {t.knot + 1, (t.fraction - frame.fraction) / (1.0 - frame.fraction)};
}

KnotNormals::KnotNormals(const SharedGeometry& geometry)
    : m_geometry(geometry),
      m_times{static_cast<std::size_t>(geometry.surface_knots()), geometry.frame()} {
    if (!geometry.data().corner_normals.empty())
        m_carried = std::make_unique<const CarriedNormals>(geometry);
    m_at.resize(m_times.count());
    for (std::size_t knot = 0; knot < m_times.knots; ++knot) {
        const bool after = !m_times.frame_is_knot() && knot >= m_times.frame_number();
        const std::size_t number = knot + (after ? 1 : 0);
        if (number == m_times.frame_number()) continue;
        const std::span<const Vec3f> points = geometry.knot_points(static_cast<int>(knot));
        m_at[number] = m_carried ? m_carried->at(points) : vertex_normals(geometry.data(), points);
    }
}

KnotNormals::~KnotNormals() = default;

const Vec3f& KnotNormals::of(std::uint32_t corner, std::size_t number) const {
    if (number == m_times.frame_number()) return m_geometry.smooth_normal(corner);
    const std::vector<Vec3f>& normals = m_at[number];
    if (m_carried) return normals[m_carried->group(corner)];
    return normals[static_cast<std::size_t>(m_geometry.data().corner_verts[corner])];
}

Vec3d KnotNormals::of(std::uint32_t corner, const KnotTime& time) const {
    const Vec3d before(of(corner, time.knot));
    if (time.fraction == 0.0) return before;
    return before + (Vec3d(of(corner, time.knot + 1)) - before) * time.fraction;
}

}  // namespace granita
