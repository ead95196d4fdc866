// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/instance_motion.h"

#include <algorithm>
#include <cmath>

#include "shade/rays/ray_offset.h"

namespace granita {
namespace {

/// A ray is tested against so many one by one; more are merged.
constexpr std::size_t kMostBoxes = 16;

/// Slabs (Kay and Kajiya 1986); a ray inside a slab's plane, where 0 times infinity is no number,
/// counts as meeting it.
bool meets_box(const Bounds3f& box, const Vec3f& start, const Vec3f& direction, float distance) {
    float nearest = 0.0f, farthest = distance;
    for (int c = 0; c < 3; ++c) {
        const float a = (box.lo[c] - start[c]) / direction[c];
        const float b = (box.hi[c] - start[c]) / direction[c];
        if (std::isnan(a) || std::isnan(b)) continue;
        nearest = std::max(nearest, std::min(a, b));
        farthest = std::min(farthest, std::max(a, b));
    }
    return nearest <= farthest;
}

}  // namespace

void InstanceMotion::add(const Bounds3f& box, const std::vector<Mat4d>& knots) {
    Bounds3f way;
    for (const Mat4d& m : knots)
        for (int corner = 0; corner < 8; ++corner)
            way.add(Vec3f(m * glm::dvec4(corner & 1 ? box.hi.x : box.lo.x,
                                         corner & 2 ? box.hi.y : box.lo.y,
                                         corner & 4 ? box.hi.z : box.lo.z, 1.0)));
    if (way.empty()) return;
    way.grow(RayOffset::kRounding * std::max(glm::length(way.lo), glm::length(way.hi)));
    if (m_boxes.size() < kMostBoxes)
        m_boxes.push_back(way);
    else
        m_boxes.back().add(way);
}

bool InstanceMotion::meet(const Vec3f& start, const Vec3f& direction, float distance) const {
    return std::ranges::any_of(
        m_boxes, [&](const Bounds3f& box) { return meets_box(box, start, direction, distance); });
}

}  // namespace granita
