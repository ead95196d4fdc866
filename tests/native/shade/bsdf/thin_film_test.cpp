// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/thin_film.h"

#include <gtest/gtest.h>

#include <complex>

#include "math/observer.h"
#include "math/sampling.h"
#include "shade/bsdf/fresnel.h"

namespace granita {
namespace {

using Complex = std::complex<double>;

/// Airy's sum at one wavelength, of all orders: amplitudes of both boundaries, in one polarisation.
double airy(Complex outer, Complex inner, Complex phase) {
    return std::norm((outer + inner * phase) / (1.0 + outer * inner * phase));
}

/// Colours of light of equal energy that a film on a body of index n + i k reflects, by integration
/// over wavelengths of exact amplitudes.
Vec3f integrated(double thickness, double film, Complex body, double cosine) {
    const Complex sine2 = 1.0 - cosine * cosine;
    const Complex in_film = std::sqrt(film * film - sine2),
                  in_body = std::sqrt(body * body - sine2);
    const auto across = [](Complex a, Complex b) { return (a - b) / (a + b); };
    const auto along = [](Complex n1, Complex a, Complex n2, Complex b) {
        return (n2 * n2 * a - n1 * n1 * b) / (n2 * n2 * a + n1 * n1 * b);
    };
    Vec3f reflected(0.0f), all(0.0f);
    for (std::size_t i = 0; i + 1 < kObserver[0].size(); ++i)
        for (int part = 0; part < 40; ++part) {
            const double t = part / 40.0, wavelength = 380.0 + 10.0 * (static_cast<double>(i) + t);
            const Complex phase =
                std::exp(Complex(0.0, 4.0 * M_PI * thickness / wavelength) * in_film);
            const double r = 0.5 * (airy(across(cosine, in_film), across(in_film, in_body), phase) +
                                    airy(along(1.0, cosine, film, in_film),
                                         along(film, in_film, body, in_body), phase));
            for (int c = 0; c < 3; ++c) {
                const auto& y = kObserver[static_cast<std::size_t>(c)];
                const double seen = y[i] * (1.0 - t) + y[i + 1] * t;
                reflected[c] += static_cast<float>(seen * r);
                all[c] += static_cast<float>(seen);
            }
        }
    return rgb_of_xyz(reflected) / rgb_of_xyz(all);
}

const FilmSpectrum* observed() {
    return film_spectrum(FilmSpectrum::Kind::Observed);
}

void expect_near(const Vec3f& a, const Vec3f& b, float most) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], most) << c;
}

TEST(ThinFilm, colors_are_those_of_exact_interference) {
    for (const float thickness : {120.0f, 350.0f, 700.0f})
        for (const float cosine : {1.0f, 0.6f, 0.2f}) {
            SCOPED_TRACE(::testing::Message() << thickness << " nm, cosine " << cosine);
            const ThinFilm film{thickness, 1.33f, observed()};
            // The sum ends after three orders, the spectrum's table has steps of 19 nm.
            expect_near(film_on_dielectric(film, cosine, 1.8f),
                        glm::clamp(integrated(thickness, 1.33, 1.8, cosine), 0.0f, 1.0f), 0.004f);
            expect_near(
                film_on_conductor(film, cosine, Vec3f(0.2f), Vec3f(3.5f)),
                glm::clamp(integrated(thickness, 1.33, Complex(0.2, 3.5), cosine), 0.0f, 1.0f),
                0.02f);
        }
}

TEST(ThinFilm, a_film_like_the_air_is_none) {
    const ThinFilm film{400.0f, 1.0f, observed()};
    for (const float cosine : {1.0f, 0.5f, 0.05f}) {
        const Vec3f f0(0.9f, 0.5f, 0.2f), dip = f82_dip(f0, Vec3f(0.7f)), n(1.3f), k(2.0f);
        expect_near(film_on_dielectric(film, cosine, 1.5f), Vec3f(fresnel_dielectric(cosine, 1.5f)),
                    1e-5f);
        expect_near(film_on_metal(film, cosine, f0, dip), fresnel_f82(f0, dip, cosine), 1e-4f);
        EXPECT_GT(film_on_conductor(film, cosine, n, k).x, fresnel_conductor(1.0f, n, k).x - 1e-3f);
    }
}

TEST(ThinFilm, a_conductor_that_absorbs_nothing_is_a_dielectric) {
    const ThinFilm film{300.0f, 1.4f, observed()};
    for (const float cosine : {0.95f, 0.4f})
        expect_near(film_on_conductor(film, cosine, Vec3f(2.2f), Vec3f(0.0f)),
                    film_on_dielectric(film, cosine, 2.2f), 1e-5f);
}

TEST(ThinFilm, what_cannot_leave_a_body_is_reflected) {
    const ThinFilm film{300.0f, 1.33f / 1.5f, observed()};
    EXPECT_EQ(film_on_dielectric(film, 0.3f, 1.0f / 1.5f), Vec3f(1.0f));
}

}  // namespace
}  // namespace granita
