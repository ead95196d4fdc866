// SPDX-License-Identifier: GPL-3.0-or-later
// How stored texels become light.
#pragma once

#include "math/srgb.h"
#include "shade/textures/texel.h"

namespace granita {

/// Of one use of an image.
struct TexelDecoder {
    bool encoded = false;  ///< colours are sRGB's numbers
    /// The colour is divided by alpha (Cycles does where the Alpha output is linked) before it is
    /// decoded.
    bool unassociate = false;

    /// Linear colour and alpha, associated: means of these are means of light.  Where `unassociate`
    /// is set, the colour that is seen is their quotient.
    Vec4f light(const std::byte* at, TexelType type) const;
    /// The colour that is seen of means of light.
    Vec4f seen(const Vec4f& light) const { return unassociate ? divided(light) : light; }
    /// The colour that is seen of an interpolated *stored* value, decoded last, as in Cycles.
    Vec4f seen_of_stored(const Vec4f& stored) const {
        const Vec4f color = seen(stored);
        return encoded ? glm::min(decoded(color), Vec4f(kLargestNumber)) : color;
    }

    static Vec4f divided(const Vec4f& texel) {
        if (texel.w == 0.0f || texel.w == 1.0f) return texel;
        return {Vec3f(texel) / texel.w, texel.w};
    }
    static Vec4f decoded(const Vec4f& texel) {
        return {linear_from_srgb(texel.x), linear_from_srgb(texel.y), linear_from_srgb(texel.z),
                texel.w};
    }
};

}  // namespace granita
