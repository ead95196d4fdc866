// SPDX-License-Identifier: GPL-3.0-or-later
// How colours answer to a difference of optical paths: Fourier transforms of their spectra over
// wave numbers (Belcour and Barla 2017, sec. 4).
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "scene/color_space.h"

namespace granita {

class FilmSpectrum {
  public:
    enum class Kind {
        Fitted,    ///< the paper's Gaussians, as Cycles before Blender 5
        Observed,  ///< of the observer's curves
    };
    using Response = std::array<std::complex<float>, 3>;  ///< a value a colour

    FilmSpectrum(Kind kind, const WorkingSpace& colors);

    Kind kind() const { return m_kind; }
    /// 1 for a path of 0.
    /// @param path nanometres.
    Response at(float path) const;

  private:
    Kind m_kind;
    std::vector<Response> m_values;  ///< evenly spaced over paths
};

/// Each is made once, and stays.
const FilmSpectrum* film_spectrum(FilmSpectrum::Kind kind, const WorkingSpace& colors = {});

}  // namespace granita
