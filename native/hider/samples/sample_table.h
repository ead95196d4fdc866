// SPDX-License-Identifier: GPL-3.0-or-later
// SampleTable(pixel, s) -> x, y, t, u, v: the same bits on every device (sample_bits.h).
#pragma once

#include <cstdint>
#include <vector>

#include "hider/samples/lens_shape.h"
#include "hider/samples/regular_lattice.h"
#include "hider/samples/sample_kernel.h"
#include "math/bounds.h"
#include "scene/scene.h"
#include "scene/shutter_warp.h"

namespace granita {

inline constexpr int kTileSize =
    16;  ///< pixels; tiles are aligned to the frame's origin (decision 2)

/// The samples of one tile, structure of arrays, sample s of tile pixel p at [p * samples + s], p =
/// y * 16 + x. x, y are pixels relative to the tile's corner; t in [0, 1]; u, v in the unit lens
/// (blades and ratio applied), as open as it is at the sample's time.
struct TileSamples {
    int samples = 0;
    /// Sixteen samples in a row, from each multiple of sixteen on, lie in one of the
    /// 4^square_digits equal squares of their pixel.  Only where sixteen divides `samples`.
    int square_digits = 0;
    std::vector<float> x, y, t, u, v;  ///< t empty without motion, u and v without lens
    /// 1 / focus distance at the sample's time; empty where the focus stands still, or without
    /// lens.
    std::vector<float> inverse_focus;
};

/// What the scene needs of the table: only what is asked for is made.
struct SampleNeeds {
    bool time = false;
    bool lens = false;
};

/// INDEPENDENT: every sample its own place, time and lens point (sample_bits.h).
/// INTERLEAVED: places as INDEPENDENT; (t, u, v) from at most 1024 classes that repeat over squares
/// of 1 to 8 pixels (Keller and Heidrich 2001).
/// REGULAR: sample = pass * cells + cell of the lattice, whose side's square is the nearest to
/// Options::samples; all pixels share a pass's time and lens point (the paper, 9.3.5). Passes:
/// Options::time_samples, or what the constructor is told where that is 0, if the frame has motion
/// or a lens, else 1. Where there are more than one the lattice is rotated (regular_lattice.h), and
/// a pass has a sample more.
class SampleTable {
  public:
    static constexpr int kDefaultPasses = 16;
    /// `frame`: what any bucket of the frame may need; the number of samples of REGULAR depends on
    /// it. Throws SceneError for counts that 32 bits cannot index.
    SampleTable(const Options& options, const Camera& camera, SampleNeeds frame = {true, true},
                int automatic_passes = kDefaultPasses);
    /// A pixel's samples.
    int samples() const { return m_samples; }
    SampleNeeds needs() const { return m_needs; }  ///< of the frame
    Sampling sampling() const { return m_sampling; }
    const RegularLattice& lattice() const { return m_lattice; }  ///< REGULAR
    std::uint32_t seed() const { return m_seed; }
    /// Makes x and y, and of t, u, v what is needed; the same bits whatever else is asked for.
    void fill_tile(Vec2i tile, SampleNeeds needs, TileSamples& out) const;
    /// Makes t of a tile that fill_tile() has filled; what else there is stays.
    void fill_times(Vec2i tile, TileSamples& out) const;
    const LensShape& lens() const { return m_lens; }

  private:
    void fill_regular(SampleNeeds needs, TileSamples& out) const;
    void fill_dimension(Vec2i tile, int dimension, std::vector<float>& out) const;
    void roll(Vec2i tile, std::vector<float>& t) const;
    void move_lens(TileSamples& samples) const;

    int m_samples;
    SampleNeeds m_needs;
    RegularLattice m_lattice;
    Sampling m_sampling;
    std::uint32_t m_seed;
    std::uint32_t m_square_digits = 0;         ///< bits::square_digits
    std::vector<SobolDimension> m_dimensions;  ///< x, y, t, u, v; unless REGULAR
    int m_class_pixels = 1;  ///< INTERLEAVED: side of the square of pixels that holds every class
    ShutterWarp m_shutter;
    int m_height;     ///< rows of the frame
    float m_rolling;  ///< Options::rolling_shutter
    LensShape m_lens;
    LensKnots m_lens_knots;
};

}  // namespace granita
