// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_samples.h"

#include <cmath>

#include "shaders/shared/raster_layout.h"

namespace granita {

int sample_lattice(int samples) {
    int side = 1;
    while (side * side < samples) ++side;
    return side;
}

RasterSamples::RasterSamples(const SampleTable& table, SampleNeeds needs,
                             const Projection& projection)
    : m_table(table),
      m_needs(needs),
      m_lens(projection.lens_radius * projection.scale),
      m_inverse_focus(static_cast<float>(1.0 / projection.focus)),
      m_lattice(sample_lattice(table.samples())) {}

void RasterSamples::load(const RasterCell& cell) {
    const auto same = [](const Rect& a, const Rect& b) {
        return a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1;
    };
    if (m_cell && same(m_cell->samples, cell.samples)) return;
    const Rect& pixels = cell.samples;
    const auto row = static_cast<std::size_t>(cell.texels.width);
    const std::size_t texels = row * static_cast<std::size_t>(cell.texels.height);
    std::vector<Vec4f> values(m_needs.lens ? 2 * texels : texels, Vec4f(0.0f));
    const auto tile_of = [](int pixel) {
        return (pixel >= 0 ? pixel : pixel - kTileSize + 1) / kTileSize;
    };
    TileSamples samples;
    for (int ty = tile_of(pixels.y0); ty <= tile_of(pixels.y1 - 1); ++ty)
        for (int tx = tile_of(pixels.x0); tx <= tile_of(pixels.x1 - 1); ++tx) {
            m_table.fill_tile({tx, ty}, m_needs, samples);
            const Rect tile{tx * kTileSize, ty * kTileSize, (tx + 1) * kTileSize,
                            (ty + 1) * kTileSize};
            const Rect part = tile.intersect(pixels);
            for (int y = part.y0; y < part.y1; ++y)
                for (int x = part.x0; x < part.x1; ++x)
                    for (int s = 0; s < samples.samples; ++s) {
                        const int pixel = (y - tile.y0) * kTileSize + x - tile.x0;
                        const auto i = static_cast<std::size_t>(pixel) * samples.samples + s;
                        const std::size_t texel =
                            static_cast<std::size_t>((y - pixels.y0) * m_lattice + s / m_lattice) *
                                row +
                            static_cast<std::size_t>((x - pixels.x0) * m_lattice + s % m_lattice);
                        values[texel] = {samples.x[i], samples.y[i],
                                         m_needs.time ? samples.t[i] : 0.0f, 0.0f};
                        if (m_needs.lens)
                            values[texels + texel] = {
                                samples.u[i] * m_lens.x, samples.v[i] * m_lens.y,
                                samples.inverse_focus.empty() ? m_inverse_focus
                                                              : samples.inverse_focus[i],
                                0.0f};
                    }
        }
    m_buffer = gl::Buffer::of(values);
    m_cell = cell;
}

void RasterSamples::bind() const {
    const gl::TexelRect& t = m_cell->texels;
    m_buffer.bind_storage(RASTER_SAMPLES);
    glUniform4i(RASTER_SAMPLE_AREA, t.x, t.y, t.width, t.height);
    glUniform2i(RASTER_SAMPLE_CORNER, m_cell->corner.x, m_cell->corner.y);
    glUniform2i(RASTER_SAMPLE_COUNT, m_lattice, m_table.samples());
}

}  // namespace granita
