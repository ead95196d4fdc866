// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/coordinates.h"
#include "shade/nodes/dimensions.h"
#include "shade/nodes/gradient_noise.h"
#include "shade/nodes/nodes.h"

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

template <std::size_t N>
void build(NodeBuilder& b) {
    const VectorSource vector =
        b.linked("Vector") || N == 1 ? b.vector("Vector") : generated_at(b, b.shift());
    const FloatSource w = b.number("W"), scale = b.number("Scale", 5.0f);
    const FloatSource detail = b.number("Detail", 2.0f), roughness = b.number("Roughness", 0.5f);
    const FloatSource lacunarity = b.number("Lacunarity", 2.0f);
    const FloatSource distortion = b.number("Distortion");
    const bool normalize = b.value("normalize", 1.0) != 0.0;
    const bool bounded = b.value("generation", 1.0) < 2.0;
    const auto octaves = [=](float d, float r, float l) {
        return Octaves{d, bounded ? std::clamp(r, 0.0f, 1.0f) : std::max(r, 0.0f), l, normalize};
    };
    b.output("Fac", b.map<float>(
                        [=](const Vec3f& v, float w_, float s, float d, float r, float l, float x) {
                            const NoisePoint<N> p = distorted<N>(noise_point<N>(v, w_, s), x);
                            return fractal_noise<N>(p, octaves(d, r, l));
                        },
                        vector, w, scale, detail, roughness, lacunarity, distortion));
    b.output_color(
        "Color", b.map<Vec3f>(
                     [=](const Vec3f& v, float w_, float s, float d, float r, float l, float x) {
                         const NoisePoint<N> p = distorted<N>(noise_point<N>(v, w_, s), x);
                         const Octaves o = octaves(d, r, l);
                         return Vec3f(fractal_noise<N>(p, o),
                                      fractal_noise<N>(moved<N>(p, static_cast<float>(N)), o),
                                      fractal_noise<N>(moved<N>(p, static_cast<float>(N + 1)), o));
                     },
                     vector, w, scale, detail, roughness, lacunarity, distortion));
}

}  // namespace

void build_noise_texture(NodeBuilder& b) {
    const std::string type = b.text("noise_type", "FBM");
    if (type != "FBM") b.warn("its type " + type + " is shown as fBM");
    with_dimensions(b, "noise_dimensions", [&](auto n) { build<n()>(b); });
}

}  // namespace granita
