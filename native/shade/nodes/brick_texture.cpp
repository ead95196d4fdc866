// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_place.h"

namespace granita {

namespace {

/// In [0, 1], of a brick's number: integer noise as Blender defines it.
float brick_noise(std::uint32_t n) {
    n = (n + 1013u) & 0x7fffffffu;
    n = (n >> 13) ^ n;
    const std::uint32_t mixed = (n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu;
    return 0.5f * (static_cast<float>(mixed) / 1073741824.0f);
}

struct BrickLayout {
    float offset, squash;
    int offset_frequency, squash_frequency;
};

struct Brick {
    float tint;        ///< between the two colours
    float x, y;        ///< from the brick's lower left
    float width, row;  ///< its size
};

Brick brick_at(const Vec3f& p, float width, float row, float bias, const BrickLayout& layout) {
    const int row_number = static_cast<int>(std::floor(p.y / row));
    float offset = 0.0f;
    if (layout.offset_frequency != 0 && layout.squash_frequency != 0) {
        if (row_number % layout.squash_frequency == 0) width *= layout.squash;
        if (row_number % layout.offset_frequency == 0) offset = width * layout.offset;
    }
    const int number = static_cast<int>(std::floor((p.x + offset) / width));
    const auto name = (static_cast<std::uint32_t>(row_number) << 16) +
                      (static_cast<std::uint32_t>(number) & 0xffffu);
    return {std::clamp(brick_noise(name) + bias, 0.0f, 1.0f),
            p.x + offset - width * static_cast<float>(number),
            p.y - row * static_cast<float>(row_number), width, row};
}

/// Share of mortar: 0 inside the brick, 1 between bricks.  Links may bring a smoothness below 0:
/// `hard` then, as before Blender 4, or none.
float mortar_at(const Brick& brick, float size, float smooth, bool hard) {
    const float nearest =
        std::min(std::min(brick.x, brick.y), std::min(brick.width - brick.x, brick.row - brick.y));
    if (nearest >= size) return 0.0f;
    if (smooth == 0.0f || (smooth < 0.0f && hard)) return 1.0f;
    const float depth = 1.0f - nearest / size;
    const float t = std::clamp(depth / smooth, 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

}  // namespace

void build_brick_texture(NodeBuilder& b) {
    const BrickLayout layout{static_cast<float>(b.value("offset", 0.5)),
                             static_cast<float>(b.value("squash", 1.0)),
                             static_cast<int>(b.value("offset_frequency", 2.0)),
                             static_cast<int>(b.value("squash_frequency", 2.0))};
    const VectorSource vector = texture_place(b);
    // x: share of mortar, y: the brick's tint.
    const VectorSource found = b.map<Vec3f>(
        [layout, hard = !b.since(4, 0)](const Vec3f& v, float scale, float size, float smooth,
                                        float bias, float width, float row) {
            const Brick brick = brick_at(v * scale, width, row, bias, layout);
            return Vec3f(mortar_at(brick, size, smooth, hard), brick.tint, 0.0f);
        },
        vector, b.number("Scale", 5.0f), b.number("Mortar Size", 0.02f), b.number("Mortar Smooth"),
        b.number("Bias"), b.number("Brick Width", 0.5f), b.number("Row Height", 0.25f));
    b.output("Fac", b.map<float>([](const Vec3f& x) { return x.x; }, found));
    b.output_color("Color", b.map<Vec3f>(
                                [](const Vec3f& x, const Vec3f& first, const Vec3f& second,
                                   const Vec3f& mortar) {
                                    const Vec3f brick = first + (second - first) * x.y;
                                    return brick + (mortar - brick) * x.x;
                                },
                                found, b.color("Color1", Vec3f(0.8f)),
                                b.color("Color2", Vec3f(0.2f)), b.color("Mortar", Vec3f(0.0f))));
}

}  // namespace granita
