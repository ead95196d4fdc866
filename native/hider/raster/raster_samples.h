// SPDX-License-Identifier: GPL-3.0-or-later
// The samples of a cell on the device, where each has a place, a time and a lens point of its own
// (the paper's per-pixel time sampling, 9.3.5).
#pragma once

#include <optional>

#include "gl/buffer.h"
#include "gl/program.h"
#include "hider/raster/raster_target.h"
#include "hider/samples/sample_table.h"
#include "math/projection.h"

namespace granita {

/// Texels along a pixel's side that hold so many samples.
int sample_lattice(int samples);

/// Used on the thread that owns OpenGL.
class RasterSamples {
  public:
    /// `table` must outlive it.
    RasterSamples(const SampleTable& table, SampleNeeds needs, const Projection& projection);

    SampleNeeds needs() const { return m_needs; }
    /// Makes those of the cell, unless it was the last one.
    void load(const RasterCell& cell);
    /// For the program in use, which includes raster/samples.glsl.
    void bind() const;

  private:
    const SampleTable& m_table;
    SampleNeeds m_needs;
    Vec2f m_lens;           ///< raster shift a unit of lens and shear
    float m_inverse_focus;  ///< where it stands still
    int m_lattice;
    std::optional<RasterCell> m_cell;
    gl::Buffer m_buffer;
};

}  // namespace granita
