// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "film/film.h"

namespace granita {

/// What a tile gives to the film, once its samples have their colours.
struct ResolvedTile {
    TileContribution contribution;
    float noise = 0.0f;  ///< film/tile_noise.h; where more samples could be taken
};

}  // namespace granita
