// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/film_spectrum.h"

#include <algorithm>
#include <cmath>
#include <list>
#include <mutex>

#include "math/observer.h"
#include "math/sampling.h"

namespace granita {
namespace {

using Complex = std::complex<float>;
using Response = FilmSpectrum::Response;

constexpr float kLongest = 60e3f / (2.0f * kPi);  ///< path, nanometres

/// XYZ of the integral of exp(-2 pi i path / wavelength) over the observer's curves.
Response observed(float path) {
    constexpr int kParts = 10;  // of the observer's steps
    Response xyz{};
    for (std::size_t i = 0; i + 1 < kObserver[0].size(); ++i)
        for (int part = 0; part < kParts; ++part) {
            const float t = static_cast<float>(part) / kParts;
            const float wavelength = 380.0f + 10.0f * (static_cast<float>(i) + t);
            const Complex wave = std::polar(1.0f, -2.0f * kPi * path / wavelength);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto& y = kObserver[c];
                xyz[c] += wave * (y[i] * (1.0f - t) + y[i + 1] * t);
            }
        }
    return xyz;
}

/// The paper's Gaussians in XYZ of light of equal energy, which is made the white of Rec. 709.
Response fitted(float path) {
    struct Gaussian {
        float size, middle, variance;
    };
    constexpr std::array<Gaussian, 4> kGaussians{{{5.4856e-13f, 1.6810e6f, 4.3278e9f},
                                                  {4.4201e-13f, 1.7953e6f, 9.3046e9f},
                                                  {5.2481e-13f, 2.2084e6f, 6.6121e9f},
                                                  {9.7470e-14f, 2.2399e6f, 4.5282e9f}}};
    constexpr std::array<float, 3> kWhite{0.95047f, 1.0f, 1.08883f};
    const float phase = 2.0f * kPi * path * 1e-9f;
    Response xyz{};
    for (std::size_t i = 0; i < kGaussians.size(); ++i) {
        const Gaussian& g = kGaussians[i];
        const float size = g.size * std::sqrt(2.0f * kPi * g.variance) *
                           std::exp(-phase * phase * g.variance) / 1.0685e-7f;
        xyz[i % 3] += kWhite[i % 3] * std::polar(size, -g.middle * phase);
    }
    return xyz;
}

Response rgb_response(const WorkingSpace& colors, const Response& xyz) {
    const Vec3f re = colors.from_xyz(Vec3f(xyz[0].real(), xyz[1].real(), xyz[2].real()));
    const Vec3f im = colors.from_xyz(Vec3f(xyz[0].imag(), xyz[1].imag(), xyz[2].imag()));
    return {Complex(re.x, im.x), Complex(re.y, im.y), Complex(re.z, im.z)};
}

}  // namespace

FilmSpectrum::FilmSpectrum(Kind kind, const WorkingSpace& colors)
    : m_kind(kind), m_values(kind == Kind::Fitted ? 4097 : 512) {  // the latter as fine as Cycles'
    const auto last = static_cast<float>(m_values.size() - 1);
    for (std::size_t i = 0; i < m_values.size(); ++i) {
        const float path = kLongest * static_cast<float>(i) / last;
        m_values[i] = rgb_response(colors, kind == Kind::Fitted ? fitted(path) : observed(path));
    }
    const Response all = m_values[0];
    for (Response& value : m_values)
        for (std::size_t c = 0; c < 3; ++c) value[c] /= all[c].real();
}

Response FilmSpectrum::at(float path) const {
    const auto last = static_cast<float>(m_values.size() - 1);
    const float place = std::clamp(path / kLongest, 0.0f, 1.0f) * last;
    const std::size_t i = std::min(static_cast<std::size_t>(place), m_values.size() - 2);
    const float t = place - static_cast<float>(i);
    Response value;
    for (std::size_t c = 0; c < 3; ++c)
        value[c] = m_values[i][c] * (1.0f - t) + m_values[i + 1][c] * t;
    return value;
}

const FilmSpectrum* film_spectrum(FilmSpectrum::Kind kind, const WorkingSpace& colors) {
    struct Entry {
        WorkingSpace colors;
        FilmSpectrum spectrum;
    };
    static std::mutex mutex;
    static std::list<Entry> known;
    const std::lock_guard lock(mutex);
    for (const Entry& entry : known)
        if (entry.spectrum.kind() == kind && entry.colors == colors) return &entry.spectrum;
    known.push_back({colors, FilmSpectrum(kind, colors)});
    return &known.back().spectrum;
}

}  // namespace granita
