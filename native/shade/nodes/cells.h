// SPDX-License-Identifier: GPL-3.0-or-later
// Points strewn one to a cell of a lattice in one to four dimensions (Worley 1996).  Blender 5.0
// strews them by another hash, but in one dimension.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "math/hash.h"
#include "math/pcg_hash.h"
#include "math/vec.h"

namespace granita {

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
    std::array<std::int32_t, (N < 4 ? 3 : 4)> cell{};
    std::ranges::copy(indices<N>(k), cell.begin());
    const auto values = pcg_hash<cell.size()>(cell);
    return {values[0], values[1], values[2]};
}

enum class Metric { Euclidean, Manhattan, Chebychev, Minkowski };

template <Metric kMetric, std::size_t N>
float length_of(const CellPoint<N>& d, float exponent = 2.0f) {
    float sum = 0.0f;
    for (const float x : d) {
        const float a = std::abs(x);
        if constexpr (N == 1 || kMetric == Metric::Manhattan)
            sum += a;
        else if constexpr (kMetric == Metric::Chebychev)
            sum = std::max(sum, a);
        else if constexpr (kMetric == Metric::Minkowski)
            sum += std::pow(a, exponent);
        else
            sum += a * a;
    }
    if constexpr (N == 1) return sum;
    if constexpr (kMetric == Metric::Minkowski) return std::pow(sum, 1.0f / exponent);
    return kMetric == Metric::Euclidean ? std::sqrt(sum) : sum;
}

/// At most length_of(), for less: of lengths by powers those of higher powers are shorter.  Powers
/// above 2 are 0 in floats where lengths are not.
template <Metric kMetric, std::size_t N>
float least_length_of(const CellPoint<N>& d, float exponent) {
    if constexpr (kMetric != Metric::Minkowski) return length_of<kMetric>(d);
    constexpr float kRounding = 1.0f - 1e-5f;  // of powers
    if (!(exponent > 0.0f && exponent <= 2.0f)) return 0.0f;
    return kRounding *
           (exponent <= 1.0f ? length_of<Metric::Manhattan>(d) : length_of<Metric::Euclidean>(d));
}

/// call(std::integral_constant) of a metric: what runs for each cell is compiled for one.
template <class Call>
auto with_metric(Metric metric, const Call& call) {
    using enum Metric;
    switch (metric) {
        case Manhattan:
            return call(std::integral_constant<Metric, Manhattan>());
        case Chebychev:
            return call(std::integral_constant<Metric, Chebychev>());
        case Minkowski:
            return call(std::integral_constant<Metric, Minkowski>());
        case Euclidean:
            break;
    }
    return call(std::integral_constant<Metric, Euclidean>());
}

constexpr int kMostReach = 2;  ///< of the cells around a place

/// A cell near another, as seen from there.
template <std::size_t N>
struct CellBeside {
    CellPoint<N> offset{};
    std::array<std::uint8_t, N> column{};  ///< that, from -kMostReach on
    int index = 0;                         ///< in an order that has the first axis fastest
    int sides = 0;                         ///< axes along which it is away
};

/// Those up to `Reach` away, in that order.
template <std::size_t N, int Reach>
constexpr auto cells_beside() {
    constexpr std::size_t kSide = 2 * Reach + 1;
    constexpr std::size_t kCells =
        kSide * (N > 1 ? kSide : 1) * (N > 2 ? kSide : 1) * (N > 3 ? kSide : 1);
    std::array<CellBeside<N>, kCells> cells{};
    for (std::size_t i = 0; i < kCells; ++i) {
        cells[i].index = static_cast<int>(i);
        for (std::size_t c = 0, rest = i; c < N; ++c, rest /= kSide) {
            const int offset = static_cast<int>(rest % kSide) - Reach;
            cells[i].offset[c] = static_cast<float>(offset);
            cells[i].column[c] = static_cast<std::uint8_t>(offset + kMostReach);
            cells[i].sides += cells[i].offset[c] != 0.0f;
        }
    }
    return cells;
}

/// Those up to one away, from the middle outwards.
template <std::size_t N>
constexpr auto cells_outwards() {
    auto cells = cells_beside<N, 1>();
    std::ranges::sort(cells, {},
                      [](const CellBeside<N>& cell) { return std::pair(cell.sides, cell.index); });
    return cells;
}

template <std::size_t N>
CellPoint<N> difference(const CellPoint<N>& a, const CellPoint<N>& b) {
    CellPoint<N> d;
    for (std::size_t c = 0; c < N; ++c) d[c] = a[c] - b[c];
    return d;
}

template <std::size_t N>
float dot(const CellPoint<N>& a, const CellPoint<N>& b) {
    float sum = 0.0f;
    for (std::size_t c = 0; c < N; ++c) sum += a[c] * b[c];
    return sum;
}

/// Cells around a place, and their points as seen from the corner of its own cell.
template <std::size_t N>
class CellsAround {
  public:
    CellsAround(const CellPoint<N>& place, float randomness, bool pcg)
        : m_randomness(randomness), m_pcg(pcg) {
        for (std::size_t c = 0; c < N; ++c) {
            m_base[c] = std::floor(place[c]);
            m_inside[c] = place[c] - m_base[c];
            for (std::size_t k = 0; k < kColumns; ++k) {
                const float offset = static_cast<float>(k) - static_cast<float>(kMostReach);
                m_least[c][k] =
                    std::max({offset - m_inside[c], m_inside[c] - (offset + m_randomness), 0.0f});
            }
        }
    }
    const CellPoint<N>& base() const { return m_base; }
    const CellPoint<N>& inside() const { return m_inside; }
    CellPoint<N> cell(const CellPoint<N>& offset) const {
        CellPoint<N> cell;
        for (std::size_t c = 0; c < N; ++c) cell[c] = m_base[c] + offset[c];
        return cell;
    }
    /// Within its cell.
    CellPoint<N> within(const CellPoint<N>& offset) const {
        return point_in_cell<N>(cell(offset), m_pcg);
    }
    CellPoint<N> point(const CellPoint<N>& offset) const { return placed(offset, within(offset)); }
    Vec3f color(const CellPoint<N>& offset) const { return color_of_cell<N>(cell(offset), m_pcg); }
    /// The same where within() of it is at hand, which is made of the same hashes in 3D.
    Vec3f color(const CellPoint<N>& offset, const CellPoint<N>& within) const {
        if constexpr (N == 3) return {within[0], within[1], within[2]};
        return color(offset);
    }

    /// `visit(cell, point, within)` of those `beside` (CellBeside) that may hold a point that is
    /// near: `is_near(way)`, with the least way to any of them along each axis.
    template <class IsNear, class Visit>
    void each(const auto& beside, const IsNear& is_near, const Visit& visit) const {
        for (const CellBeside<N>& cell : beside) {
            CellPoint<N> way;
            for (std::size_t c = 0; c < N; ++c) way[c] = m_least[c][cell.column[c]];
            if (!is_near(way)) continue;
            const CellPoint<N> place = within(cell.offset);
            visit(cell, placed(cell.offset, place), place);
        }
    }

  private:
    static constexpr std::size_t kColumns = 2 * kMostReach + 1;

    CellPoint<N> placed(const CellPoint<N>& offset, const CellPoint<N>& place) const {
        CellPoint<N> point;
        for (std::size_t c = 0; c < N; ++c) point[c] = offset[c] + place[c] * m_randomness;
        return point;
    }

    CellPoint<N> m_base, m_inside;
    /// Along each axis, from the place to the points that cells of a column may have.
    std::array<std::array<float, kColumns>, N> m_least;
    float m_randomness;
    bool m_pcg;
};

}  // namespace granita
