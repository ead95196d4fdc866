// SPDX-License-Identifier: GPL-3.0-or-later
// The levels of an image as the texture cache reads them.
//
// 8-bit sRGB images stay encoded, every level: Cycles interpolates such images before it decodes
// them, so a magnified texel border looks alike, while each coarser level is the mean of *linear*
// values, encoded again, so a far texture keeps its brightness.  Everything else is linear.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/node_graph.h"

namespace granita {

enum class TexelKind { EncodedByte, LinearByte, EncodedFloat, LinearFloat };

inline bool is_encoded(TexelKind kind) {
    return kind == TexelKind::EncodedByte || kind == TexelKind::EncodedFloat;
}
inline bool is_byte(TexelKind kind) {
    return kind == TexelKind::EncodedByte || kind == TexelKind::LinearByte;
}

float srgb_from_linear(float x);
float linear_from_srgb(float x);

/// What the header of an image says.
struct TextureHeader {
    int width = 0, height = 0;
    TexelKind kind = TexelKind::LinearByte;
    std::string error;  ///< not empty: cannot be opened
};
TextureHeader read_texture_header(const Image& image);

/// rgba, top row first.
struct TextureLevel {
    int width = 0, height = 0;
    std::vector<std::uint8_t> bytes;
    std::vector<float> floats;
};

struct TexturePyramid {
    TexelKind kind = TexelKind::LinearByte;
    std::vector<TextureLevel> levels;  ///< full size to one texel; empty when reading failed
    std::string error;
    std::uint64_t byte_count() const;
};

/// Decodes the whole image and filters it down.
std::shared_ptr<const TexturePyramid> build_texture_pyramid(const Image& image);
/// One level down: each texel the mean of what it covers.
TextureLevel half_level(const TextureLevel& level, TexelKind kind);

}  // namespace granita
