// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/grid_sweep.h"

#include <cmath>
#include <span>

#include "base/check.h"
#include "dice/point_bounds.h"

namespace granita {
namespace {

/// First, middle and last vertex stand for all: this decides how fast, not what is seen.
Sweep reach_of(const Grid& grid, const Projection& projection, const LensShape& lens) {
    const auto vertices = static_cast<std::size_t>(grid.vertex_count());
    const Vec2d radius = glm::abs(projection.scale) * projection.lens_radius * Vec2d(lens.extent());
    Sweep sweep;
    for (const std::size_t v : {std::size_t{0}, vertices / 2, vertices - 1}) {
        Vec2f place(0.0f), length(0.0f);
        for (int k = 0; k < (grid.motion ? grid.knots : 1); ++k) {
            const Vec3f& p = grid.positions[static_cast<std::size_t>(k) * vertices + v];
            const Vec3f h = projection.homogeneous(p, Vec2d(0.0));
            const Vec2f now = Vec2f(h) / h.z;
            if (k > 0) length += glm::abs(now - place);
            place = now;
            const double shear = 2.0 *
                                 std::max(std::fabs(p.z / projection.focus - 1.0),
                                          std::fabs(p.z / projection.farthest_focus() - 1.0)) /
                                 std::fabs(h.z);
            sweep.lens = glm::max(sweep.lens, Vec2f(shear * radius));
        }
        sweep.motion = glm::max(sweep.motion, length);
    }
    for (int axis = 0; axis < 2; ++axis) {
        // Not a number, at the eye plane: as far as can be.
        sweep.motion[axis] = sweep.motion[axis] < 1e4f ? sweep.motion[axis] : 1e4f;
        sweep.lens[axis] = sweep.lens[axis] < 1e4f ? sweep.lens[axis] : 1e4f;
        // Never quite still: then every order would be as good as any.
        if (grid.motion) sweep.motion[axis] = std::max(sweep.motion[axis], 0.1f);
        if (projection.has_lens()) sweep.lens[axis] = std::max(sweep.lens[axis], 0.1f);
    }
    return sweep;
}

/// What classifying reads.
const Grid& checked(const Grid& grid) {
    if (grid.opacity_varies)
        GRANITA_CHECK_EQ(grid.opacity.size(), static_cast<std::size_t>(grid.vertex_count()));
    return grid;
}

/// Adds the finite ones: micropolygons with others were left out.
void add_finite(std::span<const Vec3f> points, PointBounds& to) {
    for (const Vec3f& p : points)
        if (is_finite(p)) to.add({&p, 1});
}

}  // namespace

GridSweep::GridSweep(const Grid& grid, const Projection& projection, const LensShape& lens)
    : m_grid(&grid), m_classes(classify(checked(grid))), m_reach(reach_of(grid, projection, lens)) {
    divide(grid.motion || projection.has_lens());
    bound(projection);
    if (grid.motion)
        for (int i = 0; i < slab_count(m_boxes.size()); ++i)
            m_slabs.push_back(time_slab(m_boxes, i, projection));
}

void GridSweep::divide(bool swept) {
    const int n_u = m_grid->n_u, n_v = m_grid->n_v;
    const int wide = n_v <= GridPart::kNarrow ? GridPart::kMostInRows / n_v
                     : swept                  ? GridPart::kSwept
                                              : GridPart::kStill;
    for (int j = 0; j < n_v; j += GridPart::kHigh)
        for (int i = 0; i < n_u; i += wide)
            m_parts.push_back({i, j, std::min(wide, n_u - i), std::min(GridPart::kHigh, n_v - j)});
}

void GridSweep::bound(const Projection& projection) {
    const auto vertices = static_cast<std::size_t>(m_grid->vertex_count());
    const int segments = std::max(1, this->segments());
    m_boxes.resize(static_cast<std::size_t>(this->segments()) + 1);
    m_bounds.reserve(m_parts.size() * static_cast<std::size_t>(segments));
    std::vector<PointBounds> at(m_boxes.size(), PointBounds(projection));
    for (const GridPart& part : m_parts) {
        for (std::size_t knot = 0; knot < at.size(); ++knot) {
            at[knot] = PointBounds(projection);
            part.for_each_run(*m_grid, [&](int first, int count) {
                const std::span<const Vec3f> run(
                    &m_grid->positions[knot * vertices + static_cast<std::size_t>(first)],
                    static_cast<std::size_t>(count));
                m_classes.dropped == 0 ? at[knot].add(run) : add_finite(run, at[knot]);
            });
            m_boxes[knot].add(at[knot].box());
        }
        // In a segment everything is in the convex hull of both ends.
        for (std::size_t knot = 0; knot + 1 < at.size(); ++knot) {
            at[knot].add(at[knot + 1]);
            m_bounds.push_back(at[knot].bounds());
        }
        if (at.size() == 1) m_bounds.push_back(at[0].bounds());
    }
}

std::uint64_t GridSweep::bytes() const {
    const auto of = [](const auto& values) {
        return values.capacity() * sizeof(typename std::decay_t<decltype(values)>::value_type);
    };
    return sizeof *this + of(m_classes.classes) + of(m_classes.opacity) + of(m_parts) +
           of(m_bounds) + of(m_boxes) + of(m_slabs);
}

}  // namespace granita
