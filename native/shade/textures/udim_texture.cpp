// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/udim_texture.h"

#include <cmath>
#include <utility>

namespace granita {

namespace {

constexpr int kAcross = 10, kMostRows = 100;
constexpr int kNone = 0;

/// Number of the tile that holds a place, or kNone.  Places before the first are its repetition.
int tile_at(const Vec2f& place) {
    const Vec2f tile = glm::trunc(place);
    if (!(tile.x >= 0.0f && tile.x < kAcross && tile.y >= 0.0f && tile.y < kMostRows)) return kNone;
    return UdimTexture::kFirst + kAcross * static_cast<int>(tile.y) + static_cast<int>(tile.x);
}

}  // namespace

UdimTexture::UdimTexture(std::map<int, std::shared_ptr<const Texture>> tiles)
    : m_tiles(std::move(tiles)) {}

void UdimTexture::look_up(const TextureMode& mode, const std::vector<TexturePlace>& places,
                          std::vector<Vec4f>& out) const {
    out.assign(places.size(), Vec4f(1.0f, 0.0f, 1.0f, 1.0f));
    std::map<int, std::vector<std::size_t>> held;
    for (std::size_t i = 0; i < places.size(); ++i) held[tile_at(places[i].center)].push_back(i);
    std::vector<TexturePlace> inside;
    std::vector<Vec4f> texels;
    for (const auto& [number, which] : held) {
        const auto tile = m_tiles.find(number);
        if (tile == m_tiles.end()) continue;
        inside.clear();
        for (const std::size_t i : which) {
            inside.push_back(places[i]);
            inside.back().center -= glm::trunc(places[i].center);
        }
        tile->second->look_up(mode, inside, texels);
        for (std::size_t k = 0; k < which.size(); ++k) out[which[k]] = texels[k];
    }
}

}  // namespace granita
