// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/samples/sample_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/object_pool.h"
#include "hider/samples/sample_bits.h"

namespace granita {
namespace {

constexpr int kPixels = kTileSize * kTileSize;
constexpr int kBlockBits = 7;      ///< blocks of 128 pixels (decision 15)
constexpr int kMaxClasses = 1024;  ///< of INTERLEAVED
enum Dimension { kX, kY, kT, kU, kV };

/// [y][x] of a tile's pixels: their places in the Z-order.
constexpr std::array<std::uint8_t, kPixels> kMorton = [] {
    std::array<std::uint8_t, kPixels> places{};
    for (std::uint32_t p = 0; p < kPixels; ++p)
        for (std::uint32_t bit = 0; bit < 4; ++bit) {
            places[p] |= static_cast<std::uint8_t>((p >> bit & 1u) << 2 * bit);
            places[p] |= static_cast<std::uint8_t>((p >> (4 + bit) & 1u) << (2 * bit + 1));
        }
    return places;
}();

int nearest_square_side(int samples) {
    int side = static_cast<int>(std::sqrt(static_cast<double>(samples)));
    if (samples - side * side > (side + 1) * (side + 1) - samples) ++side;
    return side < 1 ? 1 : side;
}

int class_pixels(int samples) {
    int side = 8;
    while (side > 1 && side * side * samples > kMaxClasses) side /= 2;
    return side;
}

float fraction24(std::uint32_t bits) {
    return static_cast<float>(static_cast<std::int32_t>(bits >> 8)) * 0x1p-24f;
}
}  // namespace

SampleTable::SampleTable(const Options& options, const Camera& camera, SampleNeeds frame,
                         int automatic_passes)
    : m_samples(options.samples),
      m_needs(frame),
      m_sampling(options.sampling),
      m_seed(options.seed),
      m_shutter(options.shutter_curve),
      m_height(options.height),
      m_rolling(options.rolling_shutter),
      m_lens(camera.blades, camera.blade_rotation, Vec2f(camera.projection.lens_extent())),
      m_lens_knots(camera.lens) {
    if (options.samples < 1 || options.samples > 1 << 16)
        throw SceneError("render settings",
                         "samples must be 1 to 65536, not " + std::to_string(options.samples));
    if (options.time_samples < 0 || options.time_samples > 2048)
        throw SceneError("render settings", "time_samples must be 0 to 2048, not " +
                                                std::to_string(options.time_samples));
    if (m_sampling != Sampling::Regular) {
        m_square_digits = bits::square_digits(static_cast<std::uint32_t>(m_samples));
        for (int d = kX; d <= kV; ++d)
            m_dimensions.emplace_back(d, m_square_digits, d <= kY ? 20 : 24);
    }
    if (m_sampling == Sampling::Interleaved) m_class_pixels = class_pixels(m_samples);
    if (m_sampling == Sampling::Regular) {
        const bool blur = frame.time || (frame.lens && camera.projection.has_lens());
        const int passes = !blur                  ? 1
                           : options.time_samples ? options.time_samples
                                                  : automatic_passes;
        const int side = nearest_square_side(m_samples);
        m_lattice = {side, passes > 1 && side > 1};
        m_samples = m_lattice.cells() * passes;
    }
}

void SampleTable::fill_tile(Vec2i tile, SampleNeeds needs, TileSamples& out) const {
    const bool wants_time = needs.time, moves_lens = needs.lens && m_lens_knots.moves();
    needs.time = wants_time || moves_lens;
    out.samples = m_samples;
    out.square_digits = static_cast<int>(m_square_digits);
    const std::size_t count = static_cast<std::size_t>(kPixels) * m_samples;
    out.x.resize(count);
    out.y.resize(count);
    out.t.clear();
    out.u.resize(needs.lens ? count : 0);
    out.v.resize(needs.lens ? count : 0);
    out.inverse_focus.resize(moves_lens && m_lens_knots.refocuses() ? count : 0);
    if (m_sampling == Sampling::Regular) {
        fill_regular(needs, out);
    } else {
        fill_dimension(tile, kX, out.x);
        fill_dimension(tile, kY, out.y);
        if (needs.lens) {
            fill_dimension(tile, kU, out.u);
            fill_dimension(tile, kV, out.v);
        }
    }
    if (needs.time) fill_times(tile, out);
    if (needs.lens) m_lens.map(out.u.data(), out.v.data(), count);
    if (moves_lens) move_lens(out);
    if (!wants_time) out.t.clear();
}

void SampleTable::fill_times(Vec2i tile, TileSamples& out) const {
    out.t.resize(out.x.size());
    if (m_sampling == Sampling::Regular) {
        const int cells = m_lattice.cells();
        const auto passes = static_cast<std::uint32_t>(m_samples / cells);
        for (int s = 0; s < m_samples; ++s) {
            const auto pass = static_cast<std::uint32_t>(s / cells);
            out.t[s] = static_cast<float>(bits::cell_center(pass, passes)) * 0x1p-20f;
        }
        for (int p = 1; p < kPixels; ++p)
            std::copy_n(out.t.begin(), m_samples, out.t.begin() + std::ptrdiff_t{p} * m_samples);
    } else {
        fill_dimension(tile, kT, out.t);
    }
    if (!m_shutter.is_box())
        for (float& t : out.t) t = m_shutter.time(t);
    if (m_rolling >= 0.0f) roll(tile, out.t);
}

void SampleTable::move_lens(TileSamples& samples) const {
    for (std::size_t i = 0; i < samples.t.size(); ++i) {
        const float opening = m_lens_knots.opening(samples.t[i]);
        samples.u[i] *= opening;
        samples.v[i] *= opening;
    }
    for (std::size_t i = 0; i < samples.inverse_focus.size(); ++i)
        samples.inverse_focus[i] = m_lens_knots.inverse_focus(samples.t[i]);
}

/// A rolling shutter exposes the rows one after the other, the top one first: each sees a part
/// `m_rolling` of the time, and these parts spread over the shutter (as Cycles has it, so that one
/// setting gives one picture: t = (t - 1/2) d + (1/2 - y/n) (1 - d) + 1/2).
void SampleTable::roll(Vec2i tile, std::vector<float>& t) const {
    const std::size_t row_samples = static_cast<std::size_t>(kTileSize) * m_samples;
    for (int y = 0; y < kTileSize; ++y) {
        const int row = std::clamp(tile.y * kTileSize + y, 0, m_height - 1);
        const float start =
            (0.5f - static_cast<float>(row) / static_cast<float>(m_height)) * (1.0f - m_rolling) +
            0.5f;
        float* const times = t.data() + row_samples * y;
        for (std::size_t i = 0; i < row_samples; ++i)
            times[i] = std::clamp((times[i] - 0.5f) * m_rolling + start, 0.0f, 1.0f);
    }
}

void SampleTable::fill_dimension(Vec2i tile, int dimension, std::vector<float>& out) const {
    const bool in_classes = m_sampling == Sampling::Interleaved && dimension >= kT;
    const std::uint32_t mask = in_classes ? m_class_pixels - 1 : (1 << kBlockBits) - 1;
    const int x0 = tile.x * kTileSize, y0 = tile.y * kTileSize;
    // A tile lies in one block; shifts of negative pixels round down.
    const std::uint32_t block =
        in_classes ? bits::hash(m_seed)
                   : bits::block_seed(m_seed, static_cast<std::uint32_t>(x0 >> kBlockBits),
                                      static_cast<std::uint32_t>(y0 >> kBlockBits));
    const std::uint32_t seed = bits::dimension_seed(block, static_cast<std::uint32_t>(dimension));
    // A tile's pixels, or those with a class each, are a run of the Z-order.
    const auto samples = static_cast<std::size_t>(m_samples);
    const std::uint32_t first = in_classes ? 0
                                           : bits::morton(static_cast<std::uint32_t>(x0) & mask,
                                                          static_cast<std::uint32_t>(y0) & mask);
    const std::size_t pixels = in_classes ? (mask + 1) * (mask + 1) : kPixels;
    const std::size_t count = (pixels * samples + kSobolRun - 1) / kSobolRun * kSobolRun;
    auto run = ObjectPool<std::vector<float>>::take();
    run.resize(count);
    fill_sobol(m_dimensions[static_cast<std::size_t>(dimension)], seed,
               first * static_cast<std::uint32_t>(m_samples), count, run.data());
    for (int p = 0; p < kPixels; ++p) {
        const int x = p % kTileSize, y = p / kTileSize;
        const std::size_t place = kMorton[(static_cast<std::uint32_t>(y) & mask) * kTileSize +
                                          (static_cast<std::uint32_t>(x) & mask)];
        const float corner = dimension == kX   ? static_cast<float>(x)
                             : dimension == kY ? static_cast<float>(y)
                                               : 0.0f;
        const float* const __restrict from = run.data() + place * samples;
        float* const __restrict values = out.data() + static_cast<std::size_t>(p) * samples;
        for (std::size_t s = 0; s < samples; ++s) values[s] = corner + from[s];
    }
    ObjectPool<std::vector<float>>::give(std::move(run));
}

void SampleTable::fill_regular(SampleNeeds needs, TileSamples& out) const {
    const int cells = m_lattice.cells();
    std::vector<Vec2f> places;
    places.reserve(static_cast<std::size_t>(cells));
    for (int cell = 0; cell < cells; ++cell) places.push_back(m_lattice.place(cell));
    for (int p = 0; p < kPixels; ++p) {
        const int row = p / kTileSize, column = p % kTileSize;
        for (int s = 0; s < m_samples; ++s) {
            const std::size_t i = static_cast<std::size_t>(p) * m_samples + s;
            const auto pass = static_cast<std::uint32_t>(s / cells);
            const Vec2f place = places[static_cast<std::size_t>(s % cells)];
            out.x[i] = static_cast<float>(column) + place.x;
            out.y[i] = static_cast<float>(row) + place.y;
            if (needs.lens) {
                // With t a Hammersley set: the lens points of any stretch of the shutter are
                // spread.
                out.u[i] = fraction24(bits::reverse_bits(pass));
                out.v[i] = fraction24(bits::reverse_bits(bits::sobol_reversed(pass, 1)));
            }
        }
    }
}

}  // namespace granita
