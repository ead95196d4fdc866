// SPDX-License-Identifier: GPL-3.0-or-later
// Filtered look-ups in the levels of an image.
//
// From one texel a pixel on, the mean of light: trilinear probes along the footprint's longer axis
// (McCormack et al. 1999, "Feline").  Where texels are larger than pixels, in both directions, the
// stored numbers are interpolated and decoded last, which is how Cycles shows magnified texels;
// from two to one pixel a texel the one becomes the other.
#pragma once

#include "shade/textures/texture.h"
#include "shade/textures/tiled_image.h"

namespace granita {

/// The ellipse of a pixel in the texels of level 0.
struct TextureFootprint {
    Vec2f axis{0.0f};                     ///< along the longer axis, unit length, texels
    float longer = 0.0f, shorter = 0.0f;  ///< texels a pixel

    /// Of the parallelogram with these edges, [0,1]^2 over an image of `size` texels: its singular
    /// values.
    static TextureFootprint of(const Vec2f& along_u, const Vec2f& along_v, const Vec2f& size);

    /// The level of which a probe is a texel wide, between two of them mostly; without an end.
    float depth() const;
    float probe() const;  ///< its width, texels
};

/// The finest level that filtered() reads for a place, in an image of `size` texels that has enough
/// of them.
int finest_level(const Vec2f& size, const TextureMode& mode, const TexturePlace& place);

/// Colour as it is seen, and alpha.  Inside a ReadScope of the image's cache.
Vec4f filtered(TiledImage& image, const TextureMode& mode, const TexturePlace& place);

}  // namespace granita
