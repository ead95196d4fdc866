// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/dimensions.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_place.h"
#include "shade/nodes/voronoi.h"

namespace granita {

namespace {

Metric metric_of(const std::string& name) {
    if (name == "MANHATTAN") return Metric::Manhattan;
    if (name == "CHEBYCHEV") return Metric::Chebychev;
    if (name == "MINKOWSKI") return Metric::Minkowski;
    return Metric::Euclidean;
}

VoronoiFeature feature_of(const std::string& name) {
    if (name == "F2") return VoronoiFeature::F2;
    if (name == "SMOOTH_F1") return VoronoiFeature::SmoothF1;
    if (name == "DISTANCE_TO_EDGE") return VoronoiFeature::DistanceToEdge;
    if (name == "N_SPHERE_RADIUS") return VoronoiFeature::SphereRadius;
    return VoronoiFeature::F1;
}

template <std::size_t N>
void build(NodeBuilder& b, const VoronoiSettings& settings) {
    const VectorSource vector = N == 1 ? b.vector("Vector") : texture_place(b);
    const FloatSource w = b.number("W"), scale = b.number("Scale", 5.0f);
    const FloatSource randomness = b.number("Randomness", 1.0f),
                      exponent = b.number("Exponent", 0.5f),
                      smoothness = b.number("Smoothness", 1.0f), detail = b.number("Detail"),
                      roughness = b.number("Roughness", 0.5f),
                      lacunarity = b.number("Lacunarity", 2.0f);
    // Outputs are steps of their own: what nobody reads is not run.
    const auto map = [&]<class Out>(Out, bool colored, const auto& read) {
        return b.map<Out>(
            [=](const Vec3f& v, float w_, float s, float r, float e, float smooth, float octaves,
                float rough, float gap) {
                CellPoint<N> place;
                for (std::size_t c = 0; c < N; ++c)
                    place[c] = (N == 1 || c == 3 ? w_ : v[static_cast<int>(c)]) * s;
                const Voronoi<N> voronoi(settings, {r, e, smooth, octaves, rough, gap}, colored);
                return read(voronoi, place, s);
            },
            vector, w, scale, randomness, exponent, smoothness, detail, roughness, lacunarity);
    };
    using Noise = Voronoi<N>;
    using Place = CellPoint<N>;
    if (settings.feature == VoronoiFeature::DistanceToEdge) {
        b.output("Distance", map(float(), false, [](const Noise& noise, const Place& at, float) {
                     return noise.edge(at);
                 }));
        return;
    }
    if (settings.feature == VoronoiFeature::SphereRadius) {
        b.output("Radius", map(float(), false, [](const Noise& noise, const Place& at, float) {
                     return noise.sphere_radius(at);
                 }));
        return;
    }
    const auto unscaled = [](float x, float s) { return s != 0.0f ? x / s : 0.0f; };
    b.output("Distance", map(float(), false, [](const Noise& noise, const Place& at, float) {
                 return noise.value(at).distance;
             }));
    b.output_color("Color", map(Vec3f(), true, [](const Noise& noise, const Place& at, float) {
                       return noise.value(at).color;
                   }));
    if constexpr (N > 1)
        b.output_vector("Position",
                        map(Vec3f(), false, [=](const Noise& noise, const Place& at, float s) {
                            const Place p = noise.value(at).position;
                            Vec3f position(0.0f);
                            for (int c = 0; c < (N == 2 ? 2 : 3); ++c)
                                position[c] = unscaled(p[static_cast<std::size_t>(c)], s);
                            return position;
                        }));
    if constexpr (N == 1 || N == 4)
        b.output("W", map(float(), false, [=](const Noise& noise, const Place& at, float s) {
                     return unscaled(noise.value(at).position[N - 1], s);
                 }));
}

}  // namespace

void build_voronoi_texture(NodeBuilder& b) {
    const VoronoiSettings settings{metric_of(b.text("distance")),
                                   feature_of(b.text("feature", "F1")), b.flag("normalize"),
                                   b.since(5, 0)};
    with_dimensions(b, "voronoi_dimensions", [&](auto n) { build<n()>(b, settings); });
}

}  // namespace granita
