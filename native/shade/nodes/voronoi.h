// SPDX-License-Identifier: GPL-3.0-or-later
// Cellular noise: what Blender's Voronoi Texture tells of the points around a place, in one octave
// and, since Blender 4.0, in several.
#pragma once

#include <limits>
#include <tuple>
#include <utility>

#include "shade/nodes/cells.h"

namespace granita {

enum class VoronoiFeature { F1, F2, SmoothF1, DistanceToEdge, SphereRadius };

struct VoronoiSettings {
    Metric metric = Metric::Euclidean;
    VoronoiFeature feature = VoronoiFeature::F1;
    bool normalize = false;
    bool pcg = false;  ///< as point_in_cell()
};

struct VoronoiInputs {
    float randomness, exponent, smoothness, detail, roughness, lacunarity;
};

template <std::size_t N>
struct VoronoiValue {
    float distance = 0.0f;
    Vec3f color{0.0f};
    CellPoint<N> position{};
};

template <std::size_t N>
class Voronoi {
  public:
    /// `colored`: values have a colour.
    Voronoi(const VoronoiSettings& settings, const VoronoiInputs& in, bool colored)
        : m_settings(settings), m_in(in), m_colored(colored) {
        m_in.randomness = std::clamp(in.randomness, 0.0f, 1.0f);
        m_in.smoothness = std::clamp(0.5f * in.smoothness, std::numeric_limits<float>::min(), 0.5f);
        m_in.detail = std::clamp(in.detail, 0.0f, 15.0f);
        m_in.roughness = std::clamp(in.roughness, 0.0f, 1.0f);
        if (m_in.roughness == 0.0f) m_in.detail = 0.0f;
    }

    /// Sum of octaves, the last one by as much as it is asked for.
    VoronoiValue<N> value(const CellPoint<N>& place) const {
        VoronoiValue<N> sum;
        float amplitude = 1.0f, scale = 1.0f, most = 0.0f;
        for_octaves([&](float share) {
            VoronoiValue<N> here = octave(scaled(place, scale));
            most += share * amplitude;
            sum.distance += share * amplitude * here.distance;
            sum.color += share * amplitude * here.color;
            for (std::size_t c = 0; c < N; ++c)
                sum.position[c] += share * amplitude * (here.position[c] / scale - sum.position[c]);
            scale *= m_in.lacunarity;
            amplitude *= m_in.roughness;
        });
        if (m_settings.normalize) {
            sum.distance /= most * farthest();
            sum.color /= most;
        }
        return sum;
    }

    /// To the border of the cell.
    float edge(const CellPoint<N>& place) const {
        const float most = 0.5f + 0.5f * m_in.randomness;
        float amplitude = 1.0f, scale = 1.0f, least = 8.0f, farthest = most;
        for_octaves([&](float share) {
            const float here = edge_of_octave(scaled(place, scale)) / scale;
            const float farther = std::lerp(farthest, most / scale, amplitude);
            farthest = std::lerp(farthest, farther, share);
            const float nearer = std::lerp(least, std::min(least, here), amplitude);
            least = std::lerp(least, nearer, share);
            scale *= m_in.lacunarity;
            amplitude *= m_in.roughness;
        });
        return m_settings.normalize ? least / farthest : least;
    }

    /// Half of the way from the nearest point to its own nearest.
    float sphere_radius(const CellPoint<N>& place) const {
        const CellsAround<N> cells = around(place);
        const Near nearest = nearest_of<Metric::Euclidean>(cells, 1).first;
        float least = kFar;
        for (const CellBeside<N>& cell : kBeside) {
            if (cell.sides == 0) continue;
            CellPoint<N> other;
            for (std::size_t c = 0; c < N; ++c) other[c] = nearest.offset[c] + cell.offset[c];
            const CellPoint<N> way = difference(cells.point(other), nearest.point);
            least = std::min(least, dot(way, way));
        }
        return 0.5f * std::sqrt(least);
    }

  private:
    static constexpr float kFar = std::numeric_limits<float>::max();
    static constexpr auto kBeside = cells_beside<N, 1>(), kOutwards = cells_outwards<N>();
    static constexpr auto kAround = cells_beside<N, 2>();
    struct Near {
        float distance = kFar;
        int index = 0;  ///< of two that are as near the first counts
        CellPoint<N> offset{}, point{};

        bool operator<(const Near& other) const {
            return std::tie(distance, index) < std::tie(other.distance, other.index);
        }
    };

    CellsAround<N> around(const CellPoint<N>& place) const {
        return CellsAround<N>(place, m_in.randomness, m_settings.pcg);
    }
    /// `visit(share)` of each octave.
    template <class Visit>
    void for_octaves(const Visit& visit) const {
        const float whole = std::floor(m_in.detail), rest = m_in.detail - whole;
        for (int i = 0; i <= static_cast<int>(whole); ++i) visit(1.0f);
        if (rest > 0.0f) visit(rest);
    }
    static CellPoint<N> scaled(CellPoint<N> place, float scale) {
        for (float& x : place) x *= scale;
        return place;
    }
    /// Of a point, at most.
    float farthest() const {
        CellPoint<N> corner;
        corner.fill(0.5f + 0.5f * m_in.randomness);
        const float most = with_metric(m_settings.metric, [&](auto metric) {
            return length_of<metric()>(corner, m_in.exponent);
        });
        return m_settings.feature == VoronoiFeature::F2 ? 2.0f * most : most;
    }
    VoronoiValue<N> octave(const CellPoint<N>& place) const {
        const CellsAround<N> cells = around(place);
        return with_metric(m_settings.metric, [&](auto metric) {
            return m_settings.feature == VoronoiFeature::SmoothF1 ? smooth_octave<metric()>(cells)
                                                                  : nearest_octave<metric()>(cells);
        });
    }

    /// The nearest two points, the second one only if `count` says so.  Most cells are farther away
    /// than what was found before (in 3D a place asks 8 of 27).
    template <Metric kMetric>
    std::pair<Near, Near> nearest_of(const CellsAround<N>& cells, int count) const {
        Near first, second;
        const Near& last = count > 1 ? second : first;
        cells.each(
            kOutwards,
            [&](const CellPoint<N>& way) {
                return !(least_length_of<kMetric>(way, m_in.exponent) > last.distance);
            },
            [&](const CellBeside<N>& cell, const CellPoint<N>& point, const auto&) {
                const CellPoint<N> way = difference(point, cells.inside());
                const Near here{length_of<kMetric>(way, m_in.exponent), cell.index, cell.offset,
                                point};
                if (here < first) {
                    second = first;
                    first = here;
                } else if (here < second) {
                    second = here;
                }
            });
        return {first, second};
    }

    template <Metric kMetric>
    VoronoiValue<N> nearest_octave(const CellsAround<N>& cells) const {
        const bool is_second = m_settings.feature == VoronoiFeature::F2;
        const auto [first, second] = nearest_of<kMetric>(cells, is_second ? 2 : 1);
        const Near& found = is_second ? second : first;
        VoronoiValue<N> value{found.distance, {}, found.point};
        if (m_colored) value.color = cells.color(found.offset);
        for (std::size_t c = 0; c < N; ++c) value.position[c] += cells.base()[c];
        return value;
    }

    /// A minimum without corners, over points one after the other.
    template <Metric kMetric>
    VoronoiValue<N> smooth_octave(const CellsAround<N>& cells) const {
        VoronoiValue<N> value;
        value.distance = 8.0f;
        // What is no nearer than that by all of the smoothness changes nothing.
        const auto is_near = [&](const CellPoint<N>& way) {
            return !(least_length_of<kMetric>(way, m_in.exponent) >
                     value.distance + m_in.smoothness);
        };
        const auto visit = [&](const CellBeside<N>& cell, const CellPoint<N>& point,
                               const CellPoint<N>& within) {
            const float here = length_of<kMetric>(difference(point, cells.inside()), m_in.exponent);
            const float t =
                std::clamp(0.5f + 0.5f * (value.distance - here) / m_in.smoothness, 0.0f, 1.0f);
            const float h = t * t * (3.0f - 2.0f * t);
            float less = m_in.smoothness * h * (1.0f - h);
            value.distance += h * (here - value.distance) - less;
            less /= 1.0f + 3.0f * m_in.smoothness;
            if (m_colored && h > 0.0f)
                value.color += h * (cells.color(cell.offset, within) - value.color) - less;
            for (std::size_t c = 0; c < N; ++c)
                value.position[c] += h * (point[c] - value.position[c]) - less;
        };
        cells.each(kAround, is_near, visit);
        for (std::size_t c = 0; c < N; ++c) value.position[c] += cells.base()[c];
        return value;
    }

    float edge_of_octave(const CellPoint<N>& place) const {
        const CellsAround<N> cells = around(place);
        if constexpr (N == 1) {
            const float middle = cells.point({0.0f})[0], at = cells.inside()[0];
            return std::min(std::abs(0.5f * (middle + cells.point({-1.0f})[0]) - at),
                            std::abs(0.5f * (middle + cells.point({1.0f})[0]) - at));
        }
        const Near first = nearest_of<Metric::Euclidean>(cells, 1).first;
        const CellPoint<N> nearest = difference(first.point, cells.inside());
        float least = 8.0f;
        // No border is nearer than half of what its point is farther away.
        const auto is_near = [&](const CellPoint<N>& way) {
            return length_of<Metric::Euclidean>(way) < first.distance + 2.0f * least + 1e-5f;
        };
        cells.each(kOutwards, is_near, [&](const auto&, const CellPoint<N>& point, const auto&) {
            const CellPoint<N> way = difference(point, cells.inside());
            const CellPoint<N> across = difference(way, nearest);
            const float length = dot(across, across);
            if (!(length > 1e-4f)) return;
            least = std::min(least,
                             0.5f * (dot(nearest, across) + dot(way, across)) / std::sqrt(length));
        });
        return least;
    }

    VoronoiSettings m_settings;
    VoronoiInputs m_in;
    bool m_colored;
};

}  // namespace granita
