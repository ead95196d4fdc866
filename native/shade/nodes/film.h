// SPDX-License-Identifier: GPL-3.0-or-later
// Thin films of Principled, Glass and Metallic.
#pragma once

#include "shade/programs/surface_builder.h"

namespace granita {

struct FilmSource {
    FloatSource thickness{-1, 0.0f}, ior{-1, 1.0f};  ///< as ThinFilm
    const FilmSpectrum* spectrum = nullptr;

    bool is_there() const {
        return !thickness.is_constant() || ThinFilm{thickness.constant}.is_there();
    }
};

/// What a node's inputs say.
FilmSource film_source(NodeBuilder& b);

/// Lays it on a lobe.
void cover(LobeSource& lobe, const FilmSource& film);

}  // namespace granita
