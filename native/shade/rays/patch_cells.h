// SPDX-License-Identifier: GPL-3.0-or-later
// How far a patch lies off the quads between a lattice of its points.
#pragma once

#include <algorithm>

#include "math/vec.h"
#include "shade/rays/ray_heights.h"

namespace granita {

/// The points of a patch's cells, square and equally many along u and v, at one knot.
class PatchCells {
  public:
    /// `points` [(side + 1)^2], row by row.
    PatchCells(const Vec3f* points, int side) : m_points(points), m_side(side) {}
    const Vec3f& at(int i, int j) const { return m_points[j * (m_side + 1) + i]; }

    /// The largest height of the surface over the quads: a chord misses a curve by an eighth of its
    /// second difference, a cell's diagonal by a quarter of its twist.  At the patch's border the
    /// nearest second difference inside stands.
    float error() const {
        const auto inside = [this](int i) { return std::clamp(i, 1, m_side - 1); };
        float most = 0.0f;
        for (int j = 0; j < m_side; ++j)
            for (int i = 0; i < m_side; ++i) {
                const Vec3f &a = at(i, j), &b = at(i + 1, j), &c = at(i + 1, j + 1),
                            &d = at(i, j + 1);
                const auto height = [&](const Vec3f& off) { return height_off(off, a, b, c, d); };
                float sum = 0.25f * height(a - b + c - d);
                if (m_side > 1) {
                    const int u = inside(i), v = inside(j);
                    sum += 0.125f * height(at(u - 1, j) - 2.0f * at(u, j) + at(u + 1, j));
                    sum += 0.125f * height(at(i, v - 1) - 2.0f * at(i, v) + at(i, v + 1));
                }
                most = std::max(most, sum);
            }
        return most;
    }

    /// How far the surface lies off a side (bottom, right, top, left) that has but every `step`-th
    /// of its points.
    float error_of_side(int side, int step) const {
        const auto point = [&](int i) -> const Vec3f& {
            switch (side) {
                case 0:
                    return at(i, 0);
                case 1:
                    return at(m_side, i);
                case 2:
                    return at(i, m_side);
                default:
                    return at(0, i);
            }
        };
        float most = 0.0f;
        for (int first = 0; step > 1 && first < m_side; first += step) {
            const Vec3f a = point(first), b = point(first + step);
            for (int i = 1; i < step; ++i) {
                const Vec3f chord =
                    glm::mix(a, b, static_cast<float>(i) / static_cast<float>(step));
                most = std::max(most, glm::distance(point(first + i), chord));
            }
        }
        return most;
    }

  private:
    const Vec3f* m_points;
    int m_side;
};

}  // namespace granita
