// SPDX-License-Identifier: GPL-3.0-or-later
// Where the samples of REGULAR lie in a cell's target (regular_lattice.h).
//
// Defines: LATTICE, cells along a pixel's side; ROTATED 0 or 1; ORIGIN, ivec2: texel of the corner.

/// Of a pixel, from the cell's corner.
ivec2 first_texel(ivec2 pixel) {
    const ivec2 square = LATTICE * pixel;
#if ROTATED
    return square + ivec2(pixel.y, -pixel.x) + ORIGIN;
#else
    return square + ORIGIN;
#endif
}

/// The pixel of a texel's sample, from the cell's corner, and the place inside it.
ivec2 pixel_of(ivec2 texel, out vec2 place) {
#if ROTATED
    const vec2 t = vec2(texel - ORIGIN) + vec2(0.5, LATTICE % 2 == 1 ? 0.0 : 0.5);
    const vec2 at =
        vec2(LATTICE * t.x - t.y, t.x + LATTICE * t.y) / float(LATTICE * LATTICE + 1);
    const ivec2 pixel = ivec2(floor(at));
    place = at - vec2(pixel);
#else
    const ivec2 pixel = (texel - ORIGIN) / LATTICE;
    place = (vec2(texel - ORIGIN - pixel * LATTICE) + 0.5) / float(LATTICE);
#endif
    return pixel;
}
