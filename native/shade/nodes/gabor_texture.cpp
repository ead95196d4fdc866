// SPDX-License-Identifier: GPL-3.0-or-later
// Gabor Texture: sparse Gabor convolution (Lagae et al. 2009), of which the complex kernel tells
// phase and intensity too (Tricard et al. 2019).
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "math/hash.h"
#include "math/normalize_or.h"
#include "math/sampling.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_place.h"

namespace granita {
namespace {

using Phasor = std::complex<float>;

/// Kernels a cell of the lattice; their radius is its width.
constexpr int kKernels = 8;
/// Of a kernel's cosine, squared and integrated over the plane and space, of high frequencies.
constexpr float kPlaneIntegral = 0.25f, kSpaceIntegral = 0.17677669f;

/// Over which values are even: six deviations of the sum (Lagae et al. 2009, equation 9), whose
/// weights are 1 or -1.
float spread(float integral) {
    return 6.0f * std::sqrt(static_cast<float>(kKernels) * 0.5f * integral);
}

/// Hann's window keeps the Gaussian within its radius.
template <class V>
Phasor kernel(const V& from_center, const V& wave) {
    const float d2 = glm::dot(from_center, from_center);
    const float envelope = std::exp(-kPi * d2) * (0.5f + 0.5f * std::cos(kPi * d2));
    return std::polar(envelope, 2.0f * kPi * glm::dot(from_center, wave));
}

/// Sum over the cells around `p`: center, direction and weight are `impulse(cell, number)`'s.
template <class V, class Impulse>
Phasor sum_of_kernels(const V& p, float frequency, const Impulse& impulse) {
    constexpr int n = V::length();
    const V base = glm::floor(p), inside = p - base;
    Phasor sum(0.0f);
    for (int index = 0; index < (n == 3 ? 27 : 9); ++index) {
        V step(0.0f);
        for (int c = 0, rest = index; c < n; ++c, rest /= 3)
            step[c] = static_cast<float>(rest % 3 - 1);
        for (int k = 0; k < kKernels; ++k) {
            const auto one = impulse(base + step, static_cast<float>(3 * k));
            const V from_center = inside - step - one.center();
            if (glm::dot(from_center, from_center) < 1.0f)
                sum += one.weight() * kernel(from_center, frequency * one.direction());
        }
    }
    return sum;
}

float sign_of(float x) {
    return x < 0.5f ? -1.0f : 1.0f;
}

/// Of the plane; turned by up to a right angle either way where there is no isotropy.
struct PlaneImpulse {
    Vec2f cell;
    float seed, angle, isotropy;

    Vec2f center() const {
        return {hash_floats(cell.x, cell.y, seed + 1.0f), hash_floats(seed + 1.0f, cell.x, cell.y)};
    }
    float weight() const { return sign_of(hash_floats(cell.x, cell.y, seed + 2.0f)); }
    Vec2f direction() const {
        const float turned = angle + (hash_floats(cell.x, cell.y, seed) - 0.5f) * kPi * isotropy;
        return {std::cos(turned), std::sin(turned)};
    }
};

/// Of space; both angles of the direction turn by up to half a circle.
struct SpaceImpulse {
    Vec3f cell;
    float seed;
    Vec3f along;
    float isotropy;

    Vec3f center() const {
        return hash_color(std::array<float, 4>{cell.x, cell.y, cell.z, seed + 1.0f});
    }
    float weight() const { return sign_of(hash_floats(cell.x, cell.y, cell.z, seed + 2.0f)); }
    Vec3f direction() const {
        if (isotropy == 0.0f) return along;
        const float polar = std::acos(std::clamp(along.z, -1.0f, 1.0f)) +
                            hash_floats(cell.x, cell.y, cell.z, seed) * kPi * isotropy;
        const float azimuth = std::atan2(along.y, along.x) +
                              hash_floats(cell.z, cell.x, seed, cell.y) * kPi * isotropy;
        return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                std::cos(polar)};
    }
};

}  // namespace

void build_gabor_texture(NodeBuilder& b) {
    const VectorSource place = texture_place(b);
    const FloatSource scale = b.number("Scale", 5.0f), frequency = b.number("Frequency", 2.0f);
    const FloatSource anisotropy = b.number("Anisotropy", 1.0f);
    const auto isotropy = [](float x) { return 1.0f - std::clamp(x, 0.0f, 1.0f); };
    const bool in_plane = b.text("gabor_type", "2D") == "2D";
    // Real and imaginary part, to one.
    const VectorSource phasor =
        in_plane
            ? b.map<Vec3f>(
                  [=](const Vec3f& v, float s, float f, float a, float angle) {
                      const Phasor sum = sum_of_kernels(
                          Vec2f(v) * s, std::max(f, 0.001f), [&](const Vec2f& cell, float seed) {
                              return PlaneImpulse{cell, seed, angle, isotropy(a)};
                          });
                      return Vec3f(sum.real(), sum.imag(), 0.0f) / spread(kPlaneIntegral);
                  },
                  place, scale, frequency, anisotropy, b.number("Orientation 2D", 0.25f * kPi))
            : b.map<Vec3f>(
                  [=](const Vec3f& v, float s, float f, float a, const Vec3f& axis) {
                      const Vec3f along = normalize_or(axis, Vec3f(0.0f));
                      const Phasor sum = sum_of_kernels(
                          v * s, std::max(f, 0.001f), [&](const Vec3f& cell, float seed) {
                              return SpaceImpulse{cell, seed, along, isotropy(a)};
                          });
                      return Vec3f(sum.real(), sum.imag(), 0.0f) / spread(kSpaceIntegral);
                  },
                  place, scale, frequency, anisotropy,
                  b.vector("Orientation 3D", {1.4142136f, 1.4142136f, 0.0f}));
    b.output("Value", b.map<float>([](const Vec3f& z) { return 0.5f * z.y + 0.5f; }, phasor));
    b.output(
        "Phase",
        b.map<float>([](const Vec3f& z) { return (std::atan2(z.y, z.x) + kPi) / (2.0f * kPi); },
                     phasor));
    b.output("Intensity", b.map<float>([](const Vec3f& z) { return glm::length(z); }, phasor));
}

}  // namespace granita
