// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertices of a subdivision cage lie on its limit surface, and how much the surface bends
// between them: all that a face needs that is too small or too far away to be looked at closer.
#pragma once

#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace granita {

class SharedGeometry;

struct LimitVertices {
    std::vector<Vec3f> points;   ///< [knots][V] object space; of no usable face: the cage's own
    std::vector<Vec3f> normals;  ///< [V] unit at the frame time; zero where the surface has none
    /// [F] how far the surface may lie off two triangles between a face's corners at any knot,
    /// metres in object space; of a face of other than four corners, off a fan about its middle.
    std::vector<float> heights;
};

/// Of a subdivision surface; in parallel.
LimitVertices limit_vertices(const SharedGeometry& geometry);

/// How far a curve may lie off its chord, across the surface whose normals at its ends are given:
/// a cubic's largest height, of its slopes at both ends (Hermite's basis, t (1 - t)^2 <= 4 / 27).
inline float chord_height(const Vec3f& chord, const Vec3f& normal, const Vec3f& next_normal) {
    constexpr float kHighest = 4.0f / 27.0f;
    return kHighest * (std::abs(glm::dot(chord, normal)) + std::abs(glm::dot(chord, next_normal)));
}

}  // namespace granita
