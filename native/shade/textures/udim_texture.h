// SPDX-License-Identifier: GPL-3.0-or-later
// UDIM: an image in tiles of one unit of texture space, ten in a row, numbered from 1001 on.
#pragma once

#include <map>
#include <memory>

#include "shade/textures/texture.h"

namespace granita {

/// Reads each place in its tile; where there is none it is magenta, as in Cycles.
class UdimTexture : public Texture {
  public:
    static constexpr int kFirst = 1001;

    explicit UdimTexture(std::map<int, std::shared_ptr<const Texture>> tiles);

    void look_up(const TextureMode& mode, const std::vector<TexturePlace>& places,
                 std::vector<Vec4f>& out) const override;

  private:
    std::map<int, std::shared_ptr<const Texture>> m_tiles;  ///< by number
};

}  // namespace granita
