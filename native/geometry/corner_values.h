// SPDX-License-Identifier: GPL-3.0-or-later
// Primitive variables that are linear over a patch: its values at the four corners of its (u, v)
// and the weights between them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/attribute_request.h"
#include "geometry/shared_geometry.h"

namespace granita {

/// Weights of the patch's corners at (u, v) and their derivatives.
struct CornerWeights {
    CornerWeights(PatchKind kind, const Vec2d& uv);
    std::array<double, 4> w, du, dv;
};

/// Sum of the corners' vectors by their weights.
template <class Corners>
Vec3d blend(const Corners& at, const std::array<double, 4>& w) {
    return Vec3d(at[0]) * w[0] + Vec3d(at[1]) * w[1] + Vec3d(at[2]) * w[2] + Vec3d(at[3]) * w[3];
}

/// [4][width] at the corners (0,0), (1,0), (1,1), (0,1); a triangle's are (0,0), (1,0), (0,1).
struct CornerValues {
    std::array<std::array<double, 4>, 4> at{};
    bool encoded = false;  ///< as Attribute's
};

/// The attribute that a request names; nullptr: there is none, or it is no attribute.
const Attribute* find_attribute(const GeometryData& data, const AttributeRequest& request);

/// Zeros where the geometry has nothing of that name.  A scalar asked for as a vector fills x, y,
/// z; a missing alpha is 1.
CornerValues corner_values(const SharedGeometry& geometry, const BasePatch& patch,
                           const AttributeRequest& request);

/// Whether a source is Generated of a geometry that does not hold it: generated() then makes it.
bool in_box(const GeometryData& data, AttributeSource source);
/// The box of the points at the frame time mapped to [0, 1]^3.
Vec3d generated(const Bounds3f& box, const Vec3d& p_object);

/// Fills values, du, dv [n][width] by u and v; colours are decoded.
void interpolate(const CornerValues& corners, PatchKind kind, std::span<const Vec2d> uv, int width,
                 std::vector<float>& values, std::vector<float>& du, std::vector<float>& dv);

}  // namespace granita
