// SPDX-License-Identifier: GPL-3.0-or-later
// What drawing grids leaves behind: the define OUTPUT of grid.vert and grid.frag.

#define SURFACE 0   // the micropolygon's name, 0 is nothing
#define RADIANCE 1  // premultiplied radiance of opaque surfaces
#define LAYER 2     // the nearest transparent surface behind the layers already peeled
#define MARK 3      // no colour: the grids that lie before the opaque surfaces are marked as seen
// A layer in three passes of one target each, where a device has no four.
#define LAYER_NAME 4
#define LAYER_RADIANCE 5
#define LAYER_OPACITY 6

#define HAS_RADIANCE (OUTPUT == RADIANCE || OUTPUT == LAYER || OUTPUT == LAYER_RADIANCE)
#define HAS_OPACITY (OUTPUT == LAYER || OUTPUT == LAYER_OPACITY)
