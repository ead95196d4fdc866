// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/thin_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "shade/bsdf/fresnel.h"

namespace granita {
namespace {

using Complex = std::complex<float>;
using Response = FilmSpectrum::Response;
/// A value a polarisation: across the plane of incidence, in it.
template <class T>
using Polarised = std::array<T, 2>;

constexpr float kAllReflected = 1.0f;
/// Reflections inside the film that are told apart; more hardly change the sum.
constexpr int kOrders = 3;

/// What a boundary does to a wave.
struct Boundary {
    Polarised<float> reflectance{kAllReflected, kAllReflected};
    Polarised<Complex> shift{1.0f, 1.0f};  ///< of phase
    float cosine = 0.0f;                   ///< of what goes on
};

bool reflects_all(const Boundary& b) {
    return b.reflectance[0] == kAllReflected && b.reflectance[1] == kAllReflected;
}

Boundary dielectric_boundary(float cosine, float ior) {
    Boundary b;
    const float refracted2 = 1.0f - (1.0f - cosine * cosine) / (ior * ior);
    if (refracted2 <= 0.0f) return b;
    b.cosine = std::sqrt(refracted2);
    const float across = (cosine - ior * b.cosine) / (cosine + ior * b.cosine);
    const float along = (ior * cosine - b.cosine) / (ior * cosine + b.cosine);
    b.reflectance = {across * across, along * along};
    b.shift = {across < 0.0f ? -1.0f : 1.0f, along < 0.0f ? -1.0f : 1.0f};
    return b;
}

Complex direction_of(const Complex& z) {
    const float size = std::abs(z);
    return size > 0.0f ? z / size : Complex(1.0f);
}

Complex ratio(const Complex& a, const Complex& b) {
    return b != Complex(0.0f) ? a / b : Complex(0.0f);
}

/// Amplitudes of a body of index n + i k, relative to the film (Born and Wolf, 14.4.1).
Boundary conductor_boundary(float cosine, float n, float k) {
    const Complex index2 = Complex(n, k) * Complex(n, k);
    const Complex refracted = std::sqrt(index2 - (1.0f - cosine * cosine));  // times the index
    const Complex across = ratio(cosine - refracted, cosine + refracted);
    const Complex along = ratio(index2 * cosine - refracted, index2 * cosine + refracted);
    Boundary b;
    b.reflectance = {std::norm(across), std::norm(along)};
    b.shift = {direction_of(across), direction_of(along)};
    return b;
}

/// So thin a film is no film: its index becomes the outside's.
float index_of(const ThinFilm& film) {
    const float least = film.spectrum->kind() == FilmSpectrum::Kind::Fitted ? 30.0f : 1.0f;
    const float t = std::clamp(film.thickness / least, 0.0f, 1.0f);
    return 1.0f + (film.ior - 1.0f) * t * t * (3.0f - 2.0f * t);
}

/// The paper's equations 8 to 10, of one colour.
/// @param responses to one, two, ... passes through the film.
float reflected(const Boundary& outer, const Boundary& inner,
                const std::array<Response, kOrders>& responses, std::size_t color) {
    float sum = 0.0f;
    for (std::size_t p = 0; p < 2; ++p) {
        const float r12 = outer.reflectance[p], r23 = inner.reflectance[p];
        if (r23 == kAllReflected) {
            sum += kAllReflected;
            continue;
        }
        const float passed = 1.0f - r12, both = r12 * r23;
        const float multiple = passed * passed * r23 / (1.0f - both);
        const Complex shift = -inner.shift[p] * std::conj(outer.shift[p]);
        Complex turned = shift;
        float size = multiple - passed;
        sum += r12 + multiple;
        for (const Response& response : responses) {
            size *= std::sqrt(both);
            sum += 2.0f * size * (turned * std::conj(response[color])).real();
            turned *= shift;
        }
    }
    return std::clamp(0.5f * sum, 0.0f, 1.0f);
}

/// @param inner_boundary of a colour, by the cosine inside of the film and the film's index.
template <class InnerBoundary>
Vec3f film_reflectance(const ThinFilm& film, float cosine, const InnerBoundary& inner_boundary) {
    const float index = index_of(film);
    const Boundary outer = dielectric_boundary(std::abs(cosine), index);
    if (reflects_all(outer)) return Vec3f(kAllReflected);
    const float path = 2.0f * index * film.thickness * outer.cosine;
    std::array<Response, kOrders> responses;
    for (int m = 0; m < kOrders; ++m)
        responses[static_cast<std::size_t>(m)] =
            film.spectrum->at(static_cast<float>(m + 1) * path);
    Vec3f color(0.0f);
    for (int c = 0; c < 3; ++c)
        color[c] = reflected(outer, inner_boundary(c, outer.cosine, index), responses,
                             static_cast<std::size_t>(c));
    return color;
}

}  // namespace

Vec3f film_on_dielectric(const ThinFilm& film, float cosine, float ior) {
    return film_reflectance(film, cosine, [ior](int, float inside, float index) {
        return dielectric_boundary(inside, ior / index);
    });
}

Vec3f film_on_dielectric(const ThinFilm& film, float cosine, float ior, const Vec3f& f0) {
    Vec3f color = film_on_dielectric(film, cosine, ior);
    const float real = f0_from_ior(ior);
    if (real <= 1e-5f || color == Vec3f(kAllReflected)) return color;
    for (int c = 0; c < 3; ++c) {
        const float closeness = std::clamp((1.0f - color[c]) / (1.0f - real), 0.0f, 1.0f);
        color[c] *= 1.0f + closeness * (f0[c] / real - 1.0f);
    }
    return color;
}

Vec3f film_on_conductor(const ThinFilm& film, float cosine, const Vec3f& n, const Vec3f& k) {
    return film_reflectance(film, cosine, [&](int c, float inside, float index) {
        return conductor_boundary(inside, n[c] / index, k[c] / index);
    });
}

Vec3f film_on_metal(const ThinFilm& film, float cosine, const Vec3f& f0, const Vec3f& dip) {
    const Vec3f edge = fresnel_f82(f0, dip, kF82Cosine);
    return film_reflectance(film, cosine, [&](int c, float inside, float index) {
        const float r = std::min(f0[c], 0.999f), root = std::sqrt(r), g = edge[c];
        const float slow = (1.0f + root) / (1.0f - root), fast = (1.0f - r) / (1.0f + r);
        const float n = slow + (fast - slow) * g;
        const float k2 =
            std::max((r * (n + 1.0f) * (n + 1.0f) - (n - 1.0f) * (n - 1.0f)) / (1.0f - r), 0.0f);
        const float n_film = n / index, k_film = std::sqrt(k2) / index;
        Boundary b = conductor_boundary(inside, n_film, k_film);
        // It keeps F82's curve, from what it reflects into the film.
        const float below = (n_film - 1.0f) * (n_film - 1.0f) + k_film * k_film;
        const float above = (n_film + 1.0f) * (n_film + 1.0f) + k_film * k_film;
        const Vec3f inner_f0(below / above);
        const Vec3f inner_dip = f82_dip_for(f82_schlick(inner_f0) - Vec3f(g));
        const float reflectance = fresnel_f82(inner_f0, inner_dip, inside).x;
        b.reflectance = {reflectance, reflectance};
        return b;
    });
}

}  // namespace granita
