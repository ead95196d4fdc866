// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/film.h"

#include <algorithm>

namespace granita {

FilmSource film_source(NodeBuilder& b) {
    FilmSource film;
    film.thickness = b.number("Thin Film Thickness");
    film.ior = b.map<float>([](float ior) { return std::max(ior, 1e-5f); },
                            b.number("Thin Film IOR", 1.33f));
    const auto kind = b.since(5, 0) ? FilmSpectrum::Kind::Observed : FilmSpectrum::Kind::Fitted;
    if (film.is_there()) film.spectrum = film_spectrum(kind, b.scene().working_space);
    return film;
}

void cover(LobeSource& lobe, const FilmSource& film) {
    if (!film.is_there()) return;
    lobe.more = {film.thickness, film.ior};
    lobe.film_spectrum = film.spectrum;
}

}  // namespace granita
