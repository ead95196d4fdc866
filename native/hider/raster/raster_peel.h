// SPDX-License-Identifier: GPL-3.0-or-later
// Depth peeling of transparent grids, front to back (paper, 9.3.4): the layers so far of each
// sample, and the target that finds the next one.
#pragma once

#include <cstdint>
#include <vector>

#include "gl/framebuffer.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "hider/raster/raster_geometry.h"
#include "hider/raster/raster_output.h"
#include "hider/raster/raster_target.h"

namespace granita {

/// A piece of the depth axis, and the grids in it.
struct ZBatch {
    float farther_than = 0.0f;          ///< depth of OpenGL: 0 at infinity, 1 at the near clip
    std::vector<std::uint32_t> ranges;  ///< of RasterGeometry::transparent(), ascending
};

/// The paper's z-batches: `size` grids each, sorted by their nearest depth.  A batch holds what is
/// nearer than the nearest of the next one; grids that reach farther are in several.  `among`:
/// indices of RasterGeometry::transparent().
std::vector<ZBatch> z_batches(const RasterGeometry& geometry,
                              const std::vector<std::uint32_t>& among, double near_clip,
                              float farthest, int size);

/// Used on the thread that owns OpenGL.
class RasterPeel {
  public:
    /// `most_targets`: as RasterFrame has it; the device may have fewer.
    RasterPeel(const RasterTarget& target, int most_targets);

    /// No layers yet, in all of the cell's samples.
    void begin(const RasterCell& cell) const;
    /// The next layer.  Only what is nearer than `farther_than` and the opaque surfaces is peeled.
    void begin_layer(const RasterCell& cell, float farther_than) const;
    /// What must be drawn for a layer, in this order: all at once, or its names, and then radiance
    /// and opacity of what they name (the paper's three passes, one a colour channel, without its
    /// repetition of the whole algorithm).
    const std::vector<RasterOutput>& outputs() const { return m_outputs; }
    /// Binds the target of an output and what its shader reads.
    void begin_output(RasterOutput output, const RasterCell& cell) const;
    /// Puts what was drawn under the layers so far.
    void composite(const RasterCell& cell, int layers, float threshold) const;
    /// What the last layer has seen.
    const gl::Texture& names() const { return m_name; }
    /// -1 where a sample is saturated.
    const gl::Texture& peeled_depth() const { return m_peeled_depth; }
    /// For raster/accumulate.comp.
    void bind_result() const;

  private:
    const RasterTarget& m_target;
    // The layers so far.
    gl::Texture m_color, m_transmission, m_peeled_depth, m_peeled_name;
    // The next layer.
    gl::Texture m_radiance, m_opacity, m_name, m_layer_depth, m_depth;
    std::vector<RasterOutput> m_outputs;
    std::vector<gl::Framebuffer> m_targets;  ///< of each output
    gl::Program m_composite;
};

}  // namespace granita
