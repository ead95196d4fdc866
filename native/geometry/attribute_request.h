// SPDX-License-Identifier: GPL-3.0-or-later
// What a material wants to know at grid vertices.
#pragma once

#include <string>

namespace granita {

enum class AttributeSource {
    Named,      ///< GeometryData attribute `name`; missing = zeros
    DefaultUv,  ///< the UV map that is active for render
    DefaultColor,
    Generated,  ///< Blender's Generated: position in the object's undeformed bounding box, [0,1]^3
    ObjectPosition,  ///< object space, at the frame time
};

struct AttributeRequest {
    AttributeSource source = AttributeSource::Named;
    std::string name;
    int width = 3;
    bool derivatives = false;  ///< du, dv wanted (textures)
    bool operator==(const AttributeRequest&) const = default;
};

}  // namespace granita
