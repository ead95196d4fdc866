// SPDX-License-Identifier: GPL-3.0-or-later
// Patch::dice: a regular grid inside; along each side the vertices that the side's edge has, each
// grid vertex of the border moved onto the nearest of them (Fisher et al. 2009 stitch there; moving
// needs no other shape of micropolygon).
#include <algorithm>
#include <cmath>

#include "dice/coarsen_shading.h"
#include "dice/finish_motion.h"
#include "dice/patch.h"

namespace granita {
namespace {

/// Corners of a side in the patch's direction: bottom, right, top, left.
constexpr int kStart[4] = {0, 1, 3, 0}, kEnd[4] = {1, 2, 2, 3};

struct Layout {
    int n_u, n_v;
    int side_steps(int side) const { return side % 2 == 0 ? n_u : n_v; }
    /// Grid vertex at step i of a side.
    int vertex(int side, int i) const {
        switch (side) {
            case 0:
                return i;
            case 1:
                return i * (n_u + 1) + n_u;
            case 2:
                return n_v * (n_u + 1) + i;
            default:
                return i * (n_u + 1);
        }
    }
};

Vec2d bilinear(const Vec2d* c, double s, double t) {
    return (c[0] * (1.0 - s) + c[1] * s) * (1.0 - t) + (c[3] * (1.0 - s) + c[2] * s) * t;
}

/// For each step of a side the vertex of the edge that it lies on: the nearest, so that order is
/// kept and each is met.
std::vector<int> snapped_steps(const SideWalker& walk, const Side& side, int steps) {
    std::vector<int> ends{0};
    walk.leaf_ends(side, 0, steps, ends);
    std::vector<int> snapped(static_cast<std::size_t>(steps) + 1);
    std::size_t leaf = 1;
    for (int i = 0; i <= steps; ++i) {
        while (leaf + 1 < ends.size() && i >= ends[leaf]) ++leaf;
        snapped[static_cast<std::size_t>(i)] =
            2 * i < ends[leaf - 1] + ends[leaf] ? ends[leaf - 1] : ends[leaf];
    }
    return snapped;
}

/// Change of (u, v) over one grid step.  At a corner where a side is a point, the step in the
/// middle of the patch stands in: a texture look-up there needs a footprint too.
struct Steps {
    Steps(const Vec2d* corner_uv, const Side* sides, const Layout& grid)
        : c(corner_uv),
          n_u(grid.n_u),
          n_v(grid.n_v),
          middle_u(sides[0].collapsed || sides[2].collapsed),
          middle_v(sides[1].collapsed || sides[3].collapsed) {}
    Vec2d along_u(double t) const {
        if (middle_u) t = 0.5;
        return ((c[1] - c[0]) * (1.0 - t) + (c[2] - c[3]) * t) / n_u;
    }
    Vec2d along_v(double s) const {
        if (middle_v) s = 0.5;
        return ((c[3] - c[0]) * (1.0 - s) + (c[2] - c[1]) * s) / n_v;
    }
    const Vec2d* c;
    double n_u, n_v;
    bool middle_u, middle_v;
};

}  // namespace

std::unique_ptr<Grid> Patch::dice() const {
    const Layout layout{1 << m_rates.u, 1 << m_rates.v};
    const int n = (layout.n_u + 1) * (layout.n_v + 1);
    const std::size_t count = static_cast<std::size_t>(n);
    const SideWalker walk(*m_mesh, *m_patch);

    std::vector<Vec2d> uv(count);
    for (int j = 0; j <= layout.n_v; ++j)
        for (int i = 0; i <= layout.n_u; ++i)
            uv[static_cast<std::size_t>(j * (layout.n_u + 1) + i)] =
                bilinear(m_corner_uv, static_cast<double>(i) / layout.n_u,
                         static_cast<double>(j) / layout.n_v);
    std::vector<int> snapped[4];
    for (int side = 0; side < 4; ++side) {
        if (m_sides[side].collapsed) continue;
        const int steps = layout.side_steps(side);
        snapped[side] = snapped_steps(walk, m_sides[side], steps);
        for (int i = 0; i <= steps; ++i) {
            const double s =
                static_cast<double>(snapped[side][static_cast<std::size_t>(i)]) / steps;
            uv[static_cast<std::size_t>(layout.vertex(side, i))] =
                m_corner_uv[kStart[side]] * (1.0 - s) + m_corner_uv[kEnd[side]] * s;
        }
    }

    SurfaceSamples samples;
    m_mesh->sample(*m_patch, uv, samples);

    // The border: every point from the edge that owns it.
    const int knots = m_mesh->knot_count();
    const bool displaced = m_mesh->displaced();
    const auto copy = [&](int from, int to) {
        for (int k = 0; k < knots; ++k) {
            const std::size_t base = static_cast<std::size_t>(k) * count;
            samples.positions[base + static_cast<std::size_t>(to)] =
                samples.positions[base + static_cast<std::size_t>(from)];
            if (displaced)
                samples.offset[base + static_cast<std::size_t>(to)] =
                    samples.offset[base + static_cast<std::size_t>(from)];
        }
    };
    EdgePoint point;
    for (int side = 0; side < 4; ++side) {
        if (m_sides[side].collapsed) continue;
        const int steps = layout.side_steps(side);
        int evaluated = -1;  // step whose point the last vertex got
        for (int i = 0; i <= steps; ++i) {
            const int at = snapped[side][static_cast<std::size_t>(i)];
            const int vertex = layout.vertex(side, i);
            if (at == evaluated) {
                copy(layout.vertex(side, i - 1), vertex);
                continue;
            }
            evaluated = at;
            walk.point(m_sides[side], static_cast<double>(at) / steps, point);
            for (int k = 0; k < knots; ++k) {
                const std::size_t index =
                    static_cast<std::size_t>(k) * count + static_cast<std::size_t>(vertex);
                samples.positions[index] = point.p[k];
                if (displaced) samples.offset[index] = point.offset[k];
            }
        }
    }
    for (int side = 0; side < 4; ++side)
        if (m_sides[side].collapsed)
            for (int i = 1; i < layout.side_steps(side); ++i)
                copy(layout.vertex(side, 0), layout.vertex(side, i));

    auto grid = std::make_unique<Grid>();
    grid->key = key();
    grid->instance = static_cast<std::uint32_t>(m_mesh->instance_index());
    grid->material = m_mesh->material(m_patch->face);
    grid->n_u = layout.n_u;
    grid->n_v = layout.n_v;
    grid->knots = knots;
    grid->holdout = m_mesh->instance().holdout;
    grid->lifespan = m_mesh->instance().lifespan;
    grid->positions = std::move(samples.positions);
    if (displaced) {
        const float bound = m_mesh->displacement(grid->material).bound;
        std::uint64_t beyond = 0;
        for (std::size_t i = 0; i < grid->positions.size(); ++i) {
            grid->positions[i] += samples.offset[i];
            if (glm::length(samples.offset[i]) > bound * 1.0001f + 1e-12f) ++beyond;
        }
        if (beyond)
            m_mesh->report().warn(m_mesh->instance().name,
                                  "vertices displaced beyond the displacement bound", beyond);
    }
    finish_motion(*grid, m_mesh->view().projection);
    set_frame_positions(*grid, m_mesh->knots());
    if (!grid->bounds.visible && std::none_of(grid->positions.begin(), grid->positions.end(),
                                              [](const Vec3f& p) { return is_finite(p); })) {
        m_mesh->report().warn(m_mesh->instance().name, "a grid without any finite vertex left out");
        return nullptr;
    }
    grid->normal = std::move(samples.normal);
    grid->geometric_normal = std::move(samples.geometric_normal);

    if (Statistics* statistics = m_mesh->view().statistics) {
        std::vector<Vec3f> path;
        for (int k = 0; k < grid->knots; ++k)
            path.push_back(grid->positions[static_cast<std::size_t>(k) * count + count / 2]);
        const double spared = m_mesh->rate().spared(path.data(), grid->knots) - 1.0;
        statistics->add(Counter::PointsSpared, static_cast<std::uint64_t>(spared * n));
    }

    const Steps step(m_corner_uv, m_sides, layout);
    std::vector<Vec2d> step_u(count), step_v(count);
    for (int j = 0; j <= layout.n_v; ++j)
        for (int i = 0; i <= layout.n_u; ++i) {
            const std::size_t vertex = static_cast<std::size_t>(j * (layout.n_u + 1) + i);
            step_u[vertex] = step.along_u(static_cast<double>(j) / layout.n_v);
            step_v[vertex] = step.along_v(static_cast<double>(i) / layout.n_u);
        }
    grid->dp_du.resize(count);
    grid->dp_dv.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d su(samples.su[i]), sv(samples.sv[i]);
        grid->dp_du[i] = Vec3f(su * step_u[i].x + sv * step_u[i].y);
        grid->dp_dv[i] = Vec3f(su * step_v[i].x + sv * step_v[i].y);
    }
    dice_attributes(*grid, uv, step_u, step_v);
    if (m_mesh->rate().shading_rate() > m_mesh->rate().rate())
        coarsen_shading(*grid, m_mesh->view().projection, m_mesh->rate().shading_rate());
    return grid;
}

void Patch::dice_attributes(Grid& grid, const std::vector<Vec2d>& uv,
                            const std::vector<Vec2d>& step_u,
                            const std::vector<Vec2d>& step_v) const {
    const std::vector<AttributeRequest>& requests = m_mesh->requests(grid.material);
    grid.attributes.resize(requests.size());
    std::vector<float> by_u, by_v;
    for (std::size_t a = 0; a < requests.size(); ++a) {
        GridAttribute& out = grid.attributes[a];
        out.attribute = static_cast<int>(a);
        out.width = requests[a].width;
        m_mesh->attribute(*m_patch, requests[a], uv, out.values, by_u, by_v);
        if (!requests[a].derivatives) continue;
        const std::size_t width = static_cast<std::size_t>(out.width);
        out.du.resize(out.values.size());
        out.dv.resize(out.values.size());
        for (std::size_t i = 0; i < out.values.size(); ++i) {
            const Vec2d& u = step_u[i / width];
            const Vec2d& v = step_v[i / width];
            out.du[i] = static_cast<float>(by_u[i] * u.x + by_v[i] * u.y);
            out.dv[i] = static_cast<float>(by_u[i] * v.x + by_v[i] * v.y);
        }
    }
}

}  // namespace granita
