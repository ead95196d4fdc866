// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/filter_pieces.h"

#include <array>
#include <cmath>
#include <numbers>

namespace granita {
namespace {

constexpr int kNodes = FilterPieces::kDegree + 1;

/// Coefficients of the polynomial through the values at the nodes: divided differences (Newton),
/// then expanded by Horner's rule.
std::array<double, kNodes> interpolate(const std::array<double, kNodes>& nodes,
                                       std::array<double, kNodes> values) {
    for (int order = 1; order < kNodes; ++order)
        for (int i = kNodes - 1; i >= order; --i)
            values[i] = (values[i] - values[i - 1]) / (nodes[i] - nodes[i - order]);
    std::array<double, kNodes> out{};
    for (int i = kNodes - 1; i >= 0; --i) {
        for (int k = kNodes - 1; k > 0; --k) out[k] = out[k - 1] - nodes[i] * out[k];
        out[0] = values[i] - nodes[i] * out[0];
    }
    return out;
}

}  // namespace

FilterPieces::FilterPieces(const PixelFilter& filter)
    : pieces_a_pixel(static_cast<float>(kPieces) / filter.radius()),
      is_box(filter.is_box()),
      radius(filter.radius()),
      height(filter.evaluate(0.0f)) {
    if (is_box) return;
    std::array<double, kNodes> nodes, values;
    for (int i = 0; i < kNodes; ++i)  // of Chebyshev
        nodes[i] = -0.5 * std::cos(std::numbers::pi * (i + 0.5) / kNodes);
    for (int piece = 0; piece < kPieces; ++piece) {
        for (int i = 0; i < kNodes; ++i)
            values[i] = filter.value(filter.radius() * (piece + 0.5 + nodes[i]) / kPieces);
        const std::array<double, kNodes> c = interpolate(nodes, values);
        for (int k = 0; k < kNodes; ++k) coefficient[k][piece] = static_cast<float>(c[k]);
    }
}

}  // namespace granita
