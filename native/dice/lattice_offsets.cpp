// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/lattice_offsets.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// Of the step in the middle of a lattice: a shorter one is not of micropolygons but of the point
/// that a side is.
constexpr double kLeastStep = 0.25;
/// Of the area of a rectangle with such sides.
constexpr double kLeastArea = 0.1;

/// Among the sites of a lattice; -1 and one more than its steps lie around it.
std::size_t site_at(const ParametricPositions& places, int i, int j) {
    const int site = (j + 1) * (places.n_u + 3) + i + 1;
    return static_cast<std::size_t>(site);
}

std::size_t site_count(const ParametricPositions& places) {
    return site_at(places, places.n_u + 1, places.n_v + 1) + 1;
}

/// Whether a difference over two steps says more of the surface than of rounding.
bool exceeds_rounding(const SurfaceFrames& at, const Vec2d& step) {
    const Vec3d &p = at.p[0], way = 2.0 * (at.su[0] * step.x + at.sv[0] * step.y);
    return glm::length(way) >
           kLeastDifference * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

}  // namespace

void LatticeOffsets::find(const OpenedMesh& mesh, std::span<const Lattice> lattices, Offsets& out) {
    m_sites.clear();
    m_beside.clear();
    m_site_of.clear();
    for (const Lattice& lattice : lattices) add_sites(mesh, lattice);
    mesh.find_offsets(m_sites, false, m_found);
    mesh.find_offsets_beside(m_beside, m_found_beside);
    for (auto* values : {&out.offset, &out.by_u, &out.by_v}) values->clear();
    m_alone.clear();
    m_alone_sites.clear();
    m_first = 0;
    for (const Lattice& lattice : lattices) read(mesh, lattice, out);
    if (m_alone.empty()) return;
    mesh.find_offsets(m_alone_sites, true, m_found);
    for (std::size_t k = 0; k < m_alone.size(); ++k) {
        out.by_u[m_alone[k]] = m_found.by_u[k];
        out.by_v[m_alone[k]] = m_found.by_v[k];
    }
}

void LatticeOffsets::add_sites(const OpenedMesh& mesh, const Lattice& lattice) {
    const ParametricPositions& places = *lattice.places;
    // Polygons go on straight; what lies beside a patch of a subdivision surface is not its own.
    const bool ends = mesh.shared().subdivision() != nullptr;
    for (int j = -1; j <= places.n_v + 1; ++j)
        for (int i = -1; i <= places.n_u + 1; ++i) {
            const bool beside_u = i < 0 || i > places.n_u, beside_v = j < 0 || j > places.n_v;
            const Vec2d uv = places.regular(i, j);
            if (!beside_u && !beside_v) {
                m_site_of.push_back(static_cast<int>(m_sites.size()));
                m_sites.push_back({lattice.patch, uv});
                continue;
            }
            const bool outside = std::min(uv.x, uv.y) < 0.0 || std::max(uv.x, uv.y) > 1.0;
            if ((beside_u && beside_v) || (ends && outside)) {
                m_site_of.push_back(kNoSite);
                continue;
            }
            m_site_of.push_back(kFirstBeside - static_cast<int>(m_beside.size()));
            m_beside.push_back({lattice.patch, uv});
        }
}

void LatticeOffsets::read(const OpenedMesh& mesh, const Lattice& lattice, Offsets& out) {
    const ParametricPositions& places = *lattice.places;
    const Vec2d middle_a = places.row_step(0.5 * places.n_v);
    const Vec2d middle_b = places.column_step(0.5 * places.n_u);
    const Vec2d middle = 0.25 * (places.corner_uv[0] + places.corner_uv[1] + places.corner_uv[2] +
                                 places.corner_uv[3]);
    find_frames(mesh.shared(), *lattice.patch, {&middle, 1}, mesh.shared().frame(), m_middle);
    const bool tells = exceeds_rounding(m_middle, middle_a) && exceeds_rounding(m_middle, middle_b);
    for (std::size_t vertex = 0; vertex < places.vertex_count(); ++vertex) {
        const int i = static_cast<int>(places.from[vertex]) % (places.n_u + 1);
        const int j = static_cast<int>(places.from[vertex]) / (places.n_u + 1);
        const int site = m_site_of[m_first + site_at(places, i, j)];
        const Vec2d a = places.row_step(j), b = places.column_step(i);
        const double length_a = glm::length(a), length_b = glm::length(b);
        const double area = a.x * b.y - a.y * b.x;
        out.offset.push_back(at(site));
        if (tells && length_a > kLeastStep * glm::length(middle_a) &&
            length_b > kLeastStep * glm::length(middle_b) &&
            std::abs(area) > kLeastArea * length_a * length_b) {
            const Vec3d along_a(slope(places, i, j, true)), along_b(slope(places, i, j, false));
            out.by_u.emplace_back((along_a * b.y - along_b * a.y) / area);
            out.by_v.emplace_back((along_b * a.x - along_a * b.x) / area);
            continue;
        }
        m_alone.push_back(out.by_u.size());
        m_alone_sites.push_back({lattice.patch, places.uv[vertex]});
        out.by_u.emplace_back(0.0f);
        out.by_v.emplace_back(0.0f);
    }
    m_first += site_count(places);
}

/// Between the neighbours, or, where a patch of a subdivision surface ends, of a parabola through
/// two inside.
Vec3f LatticeOffsets::slope(const ParametricPositions& places, int i, int j, bool along_u) const {
    const auto beside = [&](int steps) -> const Vec3f* {
        const int to_i = along_u ? i + steps : i, to_j = along_u ? j : j + steps;
        if (std::min(to_i, to_j) < -1 || to_i > places.n_u + 1 || to_j > places.n_v + 1)
            return nullptr;
        const int site = m_site_of[m_first + site_at(places, to_i, to_j)];
        return site == kNoSite || !is_finite(at(site)) ? nullptr : &at(site);
    };
    const Vec3f* const before = beside(-1);
    const Vec3f* const after = beside(1);
    if (before && after) return 0.5f * (*after - *before);
    const float way = after ? 1.0f : -1.0f;
    const Vec3f& here = *beside(0);
    const Vec3f& one = after ? *after : *before;
    const Vec3f* const other = beside(after ? 2 : -2);
    return other ? way * (2.0f * one - 0.5f * *other - 1.5f * here) : way * (one - here);
}

}  // namespace granita
