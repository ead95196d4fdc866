// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/samples/regular_lattice.h"

#include <cmath>

#include "base/check.h"
#include "hider/samples/sample_bits.h"

namespace granita {

Vec2f RegularLattice::place(int cell) const {
    const auto i = static_cast<std::uint32_t>(cell), n = static_cast<std::uint32_t>(side);
    const std::uint32_t points = rotated ? n * n + 1 : n;
    const std::uint32_t column = rotated ? i : i % n;
    const std::uint32_t row = rotated ? bits::rotated_row(i, n) : i / n;
    return {static_cast<float>(bits::cell_center(column, points)) * 0x1p-20f,
            static_cast<float>(bits::cell_center(row, points)) * 0x1p-20f};
}

Vec2i RegularLattice::texel(int cell) const {
    if (!rotated) return {cell % side, cell / side};
    // Twice the texel coordinates of ((2 i + 1) / 2 n, (2 j + 1) / 2 n): whole numbers.
    const auto row = static_cast<int>(
        bits::rotated_row(static_cast<std::uint32_t>(cell), static_cast<std::uint32_t>(side)));
    const std::int64_t x = 2 * cell + 1, y = 2 * row + 1;
    const std::int64_t u = side * x + y, v = side * y - x, n = cells();
    GRANITA_CHECK_EQ(u % n, 0);
    GRANITA_CHECK_EQ(v % n, 0);
    const auto half = [](std::int64_t twice) { return static_cast<int>(std::floor(0.5 * twice)); };
    return {half(u / n), half(v / n)};
}

Vec2i RegularLattice::first_texel(Vec2i pixel) const {
    const Vec2i square = side * pixel;
    return rotated ? square + Vec2i(pixel.y, -pixel.x) : square;
}

Rect RegularLattice::texels_of(const Rect& pixels) const {
    const int lean_x0 = rotated ? pixels.y0 : 0, lean_x1 = rotated ? pixels.y1 : 0;
    const int lean_y0 = rotated ? pixels.x1 : 0, lean_y1 = rotated ? pixels.x0 : 0;
    return {side * pixels.x0 + lean_x0, side * pixels.y0 - lean_y0, side * pixels.x1 + lean_x1,
            side * pixels.y1 - lean_y1};
}

int RegularLattice::center_cell() const {
    int nearest = 0;
    float least = INFINITY;
    for (int cell = 0; cell < cells(); ++cell) {
        const Vec2f d = place(cell) - Vec2f(0.5f);
        if (glm::dot(d, d) < least) {
            least = glm::dot(d, d);
            nearest = cell;
        }
    }
    return nearest;
}

}  // namespace granita
