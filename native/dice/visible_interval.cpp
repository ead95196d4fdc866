// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/visible_interval.h"

namespace granita {
namespace {

/// Of the frame's size, by which it is taken to be larger on each side: filters and displacement.
constexpr double kBeyond = 0.125;

}  // namespace

VisibleInterval::VisibleInterval(const Projection& projection, double width, double height)
    : m_projection(projection), m_width(width), m_height(height) {}

VisibleInterval::Distances VisibleInterval::distances(const Vec3f& p) const {
    const Vec2d scale = m_projection.scale, center = m_projection.center;
    const double x = scale.x * p.x, y = scale.y * p.y, z = p.z;
    // |z / focus - 1| is at most z / focus + 1, which is linear.
    const double reach = m_projection.lens_radius * (std::max(z, 0.0) / m_projection.focus + 1.0);
    const double beyond_x = kBeyond * m_width * z + scale.x * reach;
    const double beyond_y = kBeyond * m_height * z + scale.y * reach;
    return {x + center.x * z + beyond_x, (m_width - center.x) * z - x + beyond_x,
            y + center.y * z + beyond_y, (m_height - center.y) * z - y + beyond_y,
            z - m_projection.near_clip};
}

bool VisibleInterval::is_in(const Piece& p) {
    for (int side = 0; side < kSides; ++side)
        if (is_outside(p, side)) return false;
    return true;
}

double VisibleInterval::entry(const Piece& here, const Piece& there) {
    double latest = 0.0;
    for (int side = 0; side < kSides; ++side) {
        if (!is_outside(here, side)) continue;
        double first = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 3; ++i)
            if (there[i][side] >= 0.0)
                first = std::min(first, here[i][side] / (here[i][side] - there[i][side]));
        latest = std::max(latest, first);
    }
    return latest;
}

}  // namespace granita
