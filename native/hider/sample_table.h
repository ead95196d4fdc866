// SPDX-License-Identifier: GPL-3.0-or-later
// SampleTable(pixel, s) -> x, y, t, u, v: the same bits on every device (design, section 5).
#pragma once

#include <cstdint>
#include <vector>

#include "math/bounds.h"
#include "scene/scene.h"

namespace granita {

inline constexpr int kTileSize =
    16;  ///< pixels; tiles are aligned to the frame's origin (decision 2)

/// The samples of one tile, structure of arrays, sample s of tile pixel p at [p * samples + s], p =
/// y * 16 + x. x, y are pixels relative to the tile's corner; t in [0, 1]; u, v in the unit lens
/// (blades and ratio applied).
struct TileSamples {
    int samples = 0;
    std::vector<float> x, y, t, u, v;  ///< t empty without motion, u and v without lens
};

/// What the scene needs of the table: only what is asked for is made.
struct SampleNeeds {
    bool time = false;
    bool lens = false;
};

class SampleTable {
  public:
    SampleTable(const Options& options, const Camera& camera);
    int samples() const { return m_samples; }
    Sampling sampling() const { return m_sampling; }
    void fill_tile(Vec2i tile, SampleNeeds needs, TileSamples& out) const;

  private:
    int m_samples;  ///< REGULAR: lattice * lattice
    Sampling m_sampling;
    std::uint32_t m_seed;
    std::vector<float>
        m_shutter;  ///< inverse of the shutter curve's integral, tabulated; empty = box
    int m_blades;
    float m_blade_rotation, m_lens_ratio;
};

}  // namespace granita
