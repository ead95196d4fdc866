// SPDX-License-Identifier: GPL-3.0-or-later
// The supersampled target of the raster executor and its resolve (paper, 9.3.3 and 9.3.6).
//
// A picture is drawn in cells: squares aligned to the frame, each with the filter's apron around
// it. A pixel is always computed from the target of its own cell, with the same coordinates,
// whatever bucket or crop asks for it, so its bits do not depend on them.
#pragma once

#include <memory>
#include <vector>

#include "gl/framebuffer.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "gl/vertex_array.h"
#include "hider/raster_filter.h"
#include "math/bounds.h"
#include "math/vec.h"

namespace granita {

/// The part of one cell that is asked for.
struct RasterCell {
    Vec2i corner{0, 0};    ///< frame pixel at the target's texel (0, 0)
    Rect pixels;           ///< frame pixels wanted
    Rect samples;          ///< frame pixels whose samples reach them
    gl::TexelRect texels;  ///< `samples` in the target
};

/// Used on the thread that owns OpenGL.
class RasterTarget {
  public:
    /// Throws GlError where the filter's apron at this lattice does not fit the device.
    RasterTarget(const RasterFilter& filter, int max_texture_size);

    std::vector<RasterCell> cells(const Rect& pixels) const;
    /// Side of the target in frame pixels: one cell and its apron.
    int pixel_size() const { return m_cell + 2 * m_apron; }

    /// Binds the target and clears the cell's samples: colour to the background, depth to
    /// `farthest`.
    void begin_radiance(const RasterCell& cell, const Vec4f& background, float farthest) const;
    /// The same with the micropolygons' names: 0 is none.
    void begin_surfaces(const RasterCell& cell, float farthest);

    /// Filters and downsamples the cell; [height][width] of cell.pixels.
    std::vector<Vec4f> resolve(const RasterCell& cell) const;
    /// What begin_surfaces() and drawing left of the cell's own pixels, [height * lattice][width *
    /// lattice].
    std::vector<std::uint32_t> read_surfaces(const RasterCell& cell) const;
    std::vector<float> read_depth(const RasterCell& cell) const;

  private:
    void bind(const gl::Framebuffer& framebuffer, const RasterCell& cell) const;
    gl::TexelRect own_texels(const RasterCell& cell) const;

    int m_lattice, m_apron, m_cell;
    gl::Texture m_radiance, m_depth, m_rows, m_pixels;
    gl::Framebuffer m_radiance_target, m_rows_target, m_pixels_target;
    gl::Texture m_surfaces;  ///< made at the first begin_surfaces()
    gl::Framebuffer m_surfaces_target;
    gl::Program m_filter_x, m_filter_y;
    gl::VertexArray m_no_attributes;
};

}  // namespace granita
