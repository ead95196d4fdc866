// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/lattice_stencil.h"

#include <algorithm>

namespace granita {
namespace {

constexpr int kDigits = LatticeStencil::kMostLevels + 1;
constexpr std::uint32_t kQuads = kDigits * kDigits * kDigits * kDigits;
constexpr std::uint32_t kTriangles = kDigits * kDigits * kDigits;

/// `levels` [4]: of the lattice's sides, -1 where one is a point.
LatticeStencil make(PatchKind kind, const Vec2d* corner_uv, const int* levels) {
    LatticeStencil stencil;
    const int n_u = 1 << std::max(levels[0], levels[2]);
    const int n_v = 1 << std::max(levels[1], levels[3]);
    std::vector<int> ends[4];
    for (int side = 0; side < 4; ++side) {
        const int steps = side % 2 == 0 ? n_u : n_v;
        for (int leaf = 0; levels[side] >= 0 && leaf <= 1 << levels[side]; ++leaf)
            ends[side].push_back(leaf * steps >> levels[side]);
    }
    stencil.find(corner_uv, n_u, n_v, ends);
    for (const Vec2d& uv : stencil.uv) stencil.weights.emplace_back(kind, uv);
    return stencil;
}

LatticeStencil make_numbered(std::uint32_t number) {
    const bool quad = number < kQuads;
    int levels[4];
    for (std::uint32_t i = 0, digits = quad ? number : number - kQuads; i < 4; ++i) {
        levels[i] = static_cast<int>(digits % kDigits);
        digits /= kDigits;
    }
    if (quad) {
        static const Vec2d corner_uv[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        return make(PatchKind::TrianglePair, corner_uv, levels);
    }
    const int base = triangle_base(levels);
    Vec2d corner_uv[4];
    triangle_corners(base, corner_uv);
    const int sides[4] = {levels[base], levels[(base + 1) % 3], -1, levels[(base + 2) % 3]};
    return make(PatchKind::Triangle, corner_uv, sides);
}

}  // namespace

std::uint32_t LatticeStencil::number(PatchKind kind, const int* levels) {
    std::uint32_t digits = 0;
    for (int i = kind == PatchKind::Triangle ? 2 : 3; i >= 0; --i)
        digits = digits * kDigits + static_cast<std::uint32_t>(levels[i]);
    return kind == PatchKind::Triangle ? kQuads + digits : digits;
}

const LatticeStencil& LatticeStencil::of(std::uint32_t number) {
    static const std::vector<LatticeStencil> all = [] {
        std::vector<LatticeStencil> made;
        for (std::uint32_t i = 0; i < kQuads + kTriangles; ++i) made.push_back(make_numbered(i));
        return made;
    }();
    return all[number];
}

int triangle_base(const int* levels) {
    return static_cast<int>(std::min_element(levels, levels + 3) - levels);
}

void triangle_corners(int base, Vec2d* corner_uv) {
    static const Vec2d corners[3] = {{0, 0}, {1, 0}, {0, 1}};
    for (int i = 0; i < 4; ++i) corner_uv[i] = corners[(base + std::min(i, 2)) % 3];
}

}  // namespace granita
