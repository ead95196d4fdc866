// SPDX-License-Identifier: GPL-3.0-or-later
// Cellular noise (Worley 1996) in one to four dimensions: the nearest of points strewn one to a
// cell.  Blender 5.0 strews them by another hash, but in one dimension.
#include <algorithm>
#include <limits>

#include "math/hash.h"
#include "math/pcg_hash.h"
#include "shade/nodes/coordinates.h"
#include "shade/nodes/dimensions.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

template <std::size_t N>
using CellPoint = std::array<float, N>;

template <std::size_t N>
std::array<std::int32_t, N> indices(const CellPoint<N>& k) {
    std::array<std::int32_t, N> cell;
    // Clamped: far from the origin a cell has no index, and converting it would be undefined.
    for (std::size_t c = 0; c < N; ++c)
        cell[c] = static_cast<std::int32_t>(std::clamp(k[c], -2147483520.0f, 2147483520.0f));
    return cell;
}

/// Where in its cell the point lies, [0, 1] along each axis.
template <std::size_t N>
CellPoint<N> point_in_cell(const CellPoint<N>& k, bool pcg) {
    if constexpr (N > 1)
        if (pcg) return pcg_hash<N>(indices<N>(k));
    if constexpr (N == 1) return {hash_floats(k[0])};
    if constexpr (N == 2) return {hash_floats(k[0], k[1]), hash_floats(k[0], k[1], 1.0f)};
    if constexpr (N == 3)
        return {hash_floats(k[0], k[1], k[2]), hash_floats(k[0], k[1], k[2], 1.0f),
                hash_floats(k[0], k[1], k[2], 2.0f)};
    if constexpr (N == 4)
        return {hash_floats(k[0], k[1], k[2], k[3]), hash_floats(k[3], k[0], k[1], k[2]),
                hash_floats(k[2], k[3], k[0], k[1]), hash_floats(k[1], k[2], k[3], k[0])};
}

template <std::size_t N>
Vec3f color_of_cell(const CellPoint<N>& k, bool pcg) {
    if (N == 1 || !pcg) return hash_color(k);
    std::array < std::int32_t, N<4 ? 3 : 4> cell{};
    std::ranges::copy(indices<N>(k), cell.begin());
    const auto values = pcg_hash<cell.size()>(cell);
    return {values[0], values[1], values[2]};
}

enum class Metric { Euclidean, Manhattan, Chebychev, Minkowski };

struct Settings {
    Metric metric = Metric::Euclidean;
    bool second = false;  ///< the second nearest point instead of the nearest
    bool pcg = false;
};

template <std::size_t N>
float distance_of(const CellPoint<N>& d, Metric metric, float exponent) {
    float sum = 0.0f;
    for (const float x : d) {
        const float a = std::abs(x);
        if (N == 1 || metric == Metric::Manhattan)
            sum += a;
        else if (metric == Metric::Chebychev)
            sum = std::max(sum, a);
        else if (metric == Metric::Minkowski)
            sum += std::pow(a, exponent);
        else
            sum += a * a;
    }
    if (N == 1) return sum;
    if (metric == Metric::Minkowski) return std::pow(sum, 1.0f / exponent);
    return metric == Metric::Euclidean ? std::sqrt(sum) : sum;
}

template <std::size_t N>
struct Found {
    float distance = std::numeric_limits<float>::max();
    CellPoint<N> cell{}, position{};
};

template <std::size_t N>
Found<N> find(const Vec3f& vector, float w, float scale, float randomness, float exponent,
              const Settings& settings) {
    CellPoint<N> inside, base;
    for (std::size_t c = 0; c < N; ++c) {
        const float x = (N == 1 || c == 3 ? w : vector[static_cast<int>(c)]) * scale;
        base[c] = std::floor(x);
        inside[c] = x - base[c];
    }
    const float spread = std::clamp(randomness, 0.0f, 1.0f);
    Found<N> nearest, second;
    int cells = 1;
    for (std::size_t c = 0; c < N; ++c) cells *= 3;
    for (int index = 0; index < cells; ++index) {
        CellPoint<N> cell, local, offset;
        for (std::size_t c = 0, rest = static_cast<std::size_t>(index); c < N; ++c, rest /= 3) {
            offset[c] = static_cast<float>(rest % 3) - 1.0f;
            cell[c] = base[c] + offset[c];
        }
        const CellPoint<N> strewn = point_in_cell<N>(cell, settings.pcg);
        Found<N> here;
        for (std::size_t c = 0; c < N; ++c) {
            const float place = offset[c] + strewn[c] * spread;
            local[c] = place - inside[c];
            here.position[c] = place + base[c];
        }
        here.distance = distance_of<N>(local, settings.metric, exponent);
        here.cell = cell;
        if (here.distance < nearest.distance) {
            second = nearest;
            nearest = here;
        } else if (here.distance < second.distance) {
            second = here;
        }
    }
    return settings.second ? second : nearest;
}

Metric metric_of(const std::string& name) {
    if (name == "MANHATTAN") return Metric::Manhattan;
    if (name == "CHEBYCHEV") return Metric::Chebychev;
    if (name == "MINKOWSKI") return Metric::Minkowski;
    return Metric::Euclidean;
}

template <std::size_t N>
void build(NodeBuilder& b, const Settings& settings) {
    const VectorSource vector =
        b.linked("Vector") || N == 1 ? b.vector("Vector") : generated_at(b, b.shift());
    const FloatSource w = b.number("W"), scale = b.number("Scale", 5.0f);
    const FloatSource randomness = b.number("Randomness", 1.0f),
                      exponent = b.number("Exponent", 0.5f);
    const auto at = [settings](const Vec3f& v, float w_, float s, float r, float e) {
        return find<N>(v, w_, s, r, e, settings);
    };
    // Outputs are steps of their own: what nobody reads is not run.
    const auto unscaled = [](float x, float s) { return s != 0.0f ? x / s : 0.0f; };
    b.output("Distance", b.map<float>([=](const Vec3f& v, float w_, float s, float r,
                                          float e) { return at(v, w_, s, r, e).distance; },
                                      vector, w, scale, randomness, exponent));
    b.output_color("Color", b.map<Vec3f>(
                                [=](const Vec3f& v, float w_, float s, float r, float e) {
                                    return color_of_cell<N>(at(v, w_, s, r, e).cell, settings.pcg);
                                },
                                vector, w, scale, randomness, exponent));
    if constexpr (N > 1)
        b.output_vector("Position", b.map<Vec3f>(
                                        [=](const Vec3f& v, float w_, float s, float r, float e) {
                                            const auto p = at(v, w_, s, r, e).position;
                                            Vec3f position(0.0f);
                                            for (int c = 0; c < (N == 2 ? 2 : 3); ++c)
                                                position[c] = unscaled(p[c], s);
                                            return position;
                                        },
                                        vector, w, scale, randomness, exponent));
    if constexpr (N == 1 || N == 4)
        b.output("W", b.map<float>(
                          [=](const Vec3f& v, float w_, float s, float r, float e) {
                              return unscaled(at(v, w_, s, r, e).position[N - 1], s);
                          },
                          vector, w, scale, randomness, exponent));
}

}  // namespace

void build_voronoi_texture(NodeBuilder& b) {
    const std::string feature = b.text("feature", "F1");
    if (feature != "F1" && feature != "F2") {
        b.warn("its feature " + feature + " is shown as F1");
        b.output("Radius", FloatSource{-1, 0.5f});
    }
    if (b.linked("Detail") || b.number("Detail").constant > 0.0f || b.flag("normalize"))
        b.warn("it is shown without Detail and Normalize");
    const Settings settings{metric_of(b.text("distance")), feature == "F2", b.since(5, 0)};
    with_dimensions(b, "voronoi_dimensions", [&](auto n) { build<n()>(b, settings); });
}

}  // namespace granita
