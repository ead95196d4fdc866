// SPDX-License-Identifier: GPL-3.0-or-later
// What a material wants to know at grid vertices.
#pragma once

#include <span>
#include <string>

#include "scene/geometry_data.h"

namespace granita {

enum class AttributeSource {
    Named,      ///< GeometryData attribute `name`; missing = zeros
    DefaultUv,  ///< the UV map that is active for render
    DefaultColor,
    Generated,         ///< Blender's Generated: undeformed position in the texture space, [0,1]^3
    ObjectPosition,    ///< object space, at the frame time
    PreviousPosition,  ///< object space, one frame before
    NextPosition,      ///< object space, one frame after
    CornerNormal,      ///< object space, at the frame time: linear between the unit normals of a
                       ///< polygon's corners; zeros elsewhere
    Tangent,  ///< likewise, of the UV map `name` (empty: active for render), and whether it
              ///< is mirrored (tangents.h); zeros on subdivision surfaces
    // From the point to a corner of its patch, object space, at the frame time, undisplaced; of a
    // subdivision surface on the cage, of elements zeros:
    ToCorner0,
    ToCorner1,
    ToCorner2,
    ToCorner3,
    // Of curves and points; zeros elsewhere.
    ElementRandom,   ///< a number in [0, 1] a curve or point: a hash of its index, as in Cycles
    CurveLength,     ///< of the lines between its points, object space, at the frame time
    CurveIntercept,  ///< the part of that from the root
    ElementRadius,   ///< object space, at the frame time
};

/// Whether the value is a place on the surface itself.
constexpr bool is_position(AttributeSource source) {
    return source == AttributeSource::Generated || source == AttributeSource::ObjectPosition ||
           source == AttributeSource::PreviousPosition || source == AttributeSource::NextPosition;
}

constexpr bool is_to_corner(AttributeSource source) {
    return source >= AttributeSource::ToCorner0 && source <= AttributeSource::ToCorner3;
}

/// The points of another frame that a source asks for; empty for any other, and where they are
/// those of the frame.
inline std::span<const Vec3f> neighbour_points(const GeometryData& data, AttributeSource source) {
    if (data.adjacent.empty()) return {};
    const std::span<const Vec3f> both(data.adjacent);
    if (source == AttributeSource::PreviousPosition) return both.first(both.size() / 2);
    if (source == AttributeSource::NextPosition) return both.last(both.size() / 2);
    return {};
}

struct AttributeRequest {
    AttributeSource source = AttributeSource::Named;
    std::string name;
    int width = 3;
    bool derivatives = false;  ///< du, dv wanted (textures)
    bool operator==(const AttributeRequest&) const = default;
};

}  // namespace granita
