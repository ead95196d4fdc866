// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/dimensions.h"
#include "shade/nodes/gradient_noise.h"
#include "shade/nodes/multifractal.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_place.h"

namespace granita {

namespace {

/// Far from p, so that a second noise there does not look like the first.
template <std::size_t N>
NoisePoint<N> moved(NoisePoint<N> p, float seed) {
    for (std::size_t c = 0; c < N; ++c) {
        if constexpr (N == 1)
            p[c] += 100.0f + 100.0f * hash_floats(seed);
        else
            p[c] += 100.0f + 100.0f * hash_floats(seed, static_cast<float>(c));
    }
    return p;
}

template <std::size_t N>
NoisePoint<N> distorted(const NoisePoint<N>& p, float amount) {
    if (amount == 0.0f) return p;
    NoisePoint<N> q = p;
    for (std::size_t c = 0; c < N; ++c)
        q[c] += amount * signed_noise<N>(moved<N>(p, static_cast<float>(c)));
    return q;
}

/// The point of `dimensions`; w comes last, and alone where there is one dimension.
template <std::size_t N>
NoisePoint<N> noise_point(const Vec3f& vector, float w, float scale) {
    NoisePoint<N> p;
    for (std::size_t c = 0; c < N; ++c)
        p[c] = (N == 1 || c == 3 ? w : vector[static_cast<int>(c)]) * scale;
    return p;
}

/// `noise` there and at two places far away.
template <std::size_t N, class F>
Vec3f three_noises(const NoisePoint<N>& p, const F& noise) {
    return {noise(p), noise(moved<N>(p, static_cast<float>(N))),
            noise(moved<N>(p, static_cast<float>(N + 1)))};
}

struct NoisePlace {
    VectorSource vector;
    FloatSource w, scale;
};

template <std::size_t N>
NoisePlace noise_place(NodeBuilder& b) {
    return {N == 1 ? b.vector("Vector") : texture_place(b), b.number("W"), b.number("Scale", 5.0f)};
}

/// Value and colour of one kind of noise: `octaves_of` makes of the numbers `sources` what `noise`
/// reads besides its place.
template <std::size_t N, class OctavesOf, class Noise, class... Sources>
void build_distorted(NodeBuilder& b, OctavesOf octaves_of, Noise noise, const Sources&... sources) {
    const auto [vector, w, scale] = noise_place<N>(b);
    const FloatSource distortion = b.number("Distortion");
    b.output("Fac", b.map<float>(
                        [=](const Vec3f& v, float w_, float s, float x, auto... numbers) {
                            const NoisePoint<N> p = distorted<N>(noise_point<N>(v, w_, s), x);
                            return noise(p, octaves_of(numbers...));
                        },
                        vector, w, scale, distortion, sources...));
    b.output_color("Color",
                   b.map<Vec3f>(
                       [=](const Vec3f& v, float w_, float s, float x, auto... numbers) {
                           const NoisePoint<N> p = distorted<N>(noise_point<N>(v, w_, s), x);
                           const auto octaves = octaves_of(numbers...);
                           return three_noises<N>(
                               p, [&](const NoisePoint<N>& q) { return noise(q, octaves); });
                       },
                       vector, w, scale, distortion, sources...));
}

/// fBm alone, which is brought to [0, 1] where that is asked for.
template <std::size_t N>
void build_fbm(NodeBuilder& b) {
    const bool normalize = b.value("normalize", 1.0) != 0.0;
    const bool bounded = !b.since(4, 0);
    build_distorted<N>(
        b,
        [=](float d, float r, float l) {
            return Octaves{d, bounded ? std::clamp(r, 0.0f, 1.0f) : std::max(r, 0.0f), l,
                           normalize};
        },
        [](const NoisePoint<N>& p, const Octaves& octaves) { return fractal_noise<N>(p, octaves); },
        b.number("Detail", 2.0f), b.number("Roughness", 0.5f), b.number("Lacunarity", 2.0f));
}

/// The other types of Noise Texture, since Blender 4.1.
template <std::size_t N>
void build_multifractal(NodeBuilder& b, Multifractal type) {
    build_distorted<N>(
        b,
        [](float d, float r, float l, float o, float g) {
            return MultifractalOctaves{std::clamp(d, 0.0f, 15.0f) + 1.0f, std::max(r, 0.0f), l, o,
                                       g};
        },
        [type](const NoisePoint<N>& p, const MultifractalOctaves& octaves) {
            return multifractal<N>(type, p, octaves);
        },
        b.number("Detail", 2.0f), b.number("Roughness", 0.5f), b.number("Lacunarity", 2.0f),
        b.number("Offset"), b.number("Gain", 1.0f));
}

/// An octave's amplitude is lacunarity^-dimension of that before.
template <std::size_t N>
void build_musgrave(NodeBuilder& b, Multifractal type) {
    const auto [vector, w, scale] = noise_place<N>(b);
    const FloatSource detail = b.number("Detail", 2.0f), dimension = b.number("Dimension", 2.0f);
    const FloatSource lacunarity = b.number("Lacunarity", 2.0f), offset = b.number("Offset");
    const FloatSource gain = b.number("Gain", 1.0f);
    b.output(
        "Fac",
        b.map<float>(
            [=](const Vec3f& v, float w_, float s, float d, float h, float l, float o, float g) {
                l = std::max(l, 1e-5f);
                const MultifractalOctaves octaves{std::clamp(d, 0.0f, 15.0f),
                                                  std::pow(l, -std::max(h, 1e-5f)), l, o, g};
                return multifractal<N>(type, noise_point<N>(v, w_, s), octaves);
            },
            vector, w, scale, detail, dimension, lacunarity, offset, gain));
}

}  // namespace

void build_noise_texture(NodeBuilder& b) {
    const Multifractal type = multifractal_of(b.text("noise_type", "FBM"));
    with_dimensions(b, "noise_dimensions", [&](auto n) {
        if (type == Multifractal::Fbm)
            build_fbm<n()>(b);
        else
            build_multifractal<n()>(b, type);
    });
}

void build_musgrave_texture(NodeBuilder& b) {
    const Multifractal type = multifractal_of(b.text("musgrave_type", "FBM"));
    with_dimensions(b, "musgrave_dimensions", [&](auto n) { build_musgrave<n()>(b, type); });
}

}  // namespace granita
