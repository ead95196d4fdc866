// SPDX-License-Identifier: GPL-3.0-or-later
// The supersampled target of the raster executor and its resolve (paper, 9.3.3 and 9.3.6).
//
// A picture is drawn in cells: squares aligned to the frame, each with the filter's margin around
// it. A pixel is always computed from the target of its own cell, with the same coordinates,
// whatever bucket or crop asks for it, so its bits do not depend on them.
//
// The target has layers, one for each time and lens pass that a draw serves at once: the paper's
// multibuffer accumulation (9.3.5, listing 2).  One layer is its multipass accumulation.
#pragma once

#include <memory>
#include <vector>

#include "gl/buffer.h"
#include "gl/framebuffer.h"
#include "gl/program.h"
#include "gl/readback.h"
#include "gl/shader_source.h"
#include "gl/texture.h"
#include "gl/vertex_array.h"
#include "hider/raster/raster_filter.h"
#include "math/bounds.h"
#include "math/vec.h"

namespace granita {

class RasterSamples;

/// The part of one cell that is asked for.
struct RasterCell {
    Vec2i corner{0, 0};    ///< frame pixel at the target's texel (0, 0)
    Rect pixels;           ///< frame pixels wanted
    Rect samples;          ///< frame pixels whose samples reach them
    gl::TexelRect texels;  ///< `samples` in the target
};

/// What a sample sees behind all surfaces: one colour, or the world at the corners of pixels,
/// bilinear in between.
struct RasterBackground {
    Vec4f constant{0.0f};        ///< premultiplied
    Rect pixels;                 ///< empty: constant; else all pixels whose samples are drawn
    int passes = 1;              ///< 1, or one image for each
    std::vector<Vec4f> corners;  ///< [passes][height + 1][width + 1]
};

/// Used on the thread that owns OpenGL.
class RasterTarget {
  public:
    /// Throws GlError where the filter's margin at this lattice does not fit the device.
    /// `most_layers`: wanted at once; fewer where they are large.
    RasterTarget(const RasterFilter& filter, int most_layers, int max_texture_size);

    std::vector<RasterCell> cells(const Rect& pixels) const;
    /// Side of the target in frame pixels: one cell and its margin.
    int pixel_size() const { return m_cell + 2 * m_margin; }
    int texel_size() const { return m_texel_size; }
    int layers() const { return m_layers; }
    const RegularLattice& lattice() const { return m_lattice; }
    /// The target's texel at the first texel of a cell's corner pixel: a rotated cell is a rotated
    /// square in the target.
    Vec2i origin() const { return m_origin; }
    /// Of raster/lattice.glsl.
    gl::Defines lattice_defines() const;

    /// Binds the target and clears the depth of the cell's samples to `farthest`.  Their colour is
    /// nothing, as accumulating has left it; cleared where an error has kept it from that.
    void begin_radiance(const RasterCell& cell, float farthest);
    /// What was drawn has been accumulated, and the colour of all samples is nothing again.
    void emptied() { m_empty = true; }
    /// Binds the target of the micropolygons' names and clears these, to 0, which is none, and the
    /// depth of the cell's samples.
    void begin_surfaces(const RasterCell& cell, float farthest);
    /// Binds a target of the same size for drawing into the cell's samples.
    void bind(const gl::Framebuffer& framebuffer, const RasterCell& cell) const;

    /// Runs the compute shader in use over the cell's samples.
    void dispatch(const RasterCell& cell, int layers) const;

    const gl::Texture& radiance() const { return m_radiance; }
    const gl::Texture& depth() const { return m_depth; }
    const gl::Texture& surfaces() const { return m_surfaces; }
    /// The mean of the passes, which resolve() filters.
    const gl::Texture& mean() const { return m_mean; }

    /// Filters and downsamples the cell; Vec4f, [height][width] of cell.pixels.  `samples`: where
    /// the filter gathers them, else nullptr.
    gl::Readback resolve(const RasterCell& cell, const RasterSamples* samples) const;
    /// Of what begin_surfaces() and drawing left in layer 0: the depths of the samples nearest to
    /// the pixels' centres, 0 where they see nothing; [height][width] of cell.pixels.
    std::vector<float> center_depths(const RasterCell& cell, const RasterSamples* samples);
    /// What begin_surfaces() and drawing left in layer 0 of the cell's own pixels,
    /// [height][width][lattice().cells()].
    std::vector<std::uint32_t> read_surfaces(const RasterCell& cell) const;
    std::vector<float> read_depth(const RasterCell& cell) const;

  private:
    /// The target's texels that hold the samples of these frame pixels.
    gl::TexelRect texels_of(const RasterCell& cell, const Rect& pixels) const;
    /// Texels of the cell's own pixels in the order of samples.
    template <class T>
    std::vector<T> by_sample(const RasterCell& cell, const std::vector<T>& texels) const;
    /// The cell's own pixels, relative to the first one of whole cells.
    gl::TexelRect own_pixels(const RasterCell& cell) const;
    /// Draws a pass of the resolve over a part of a target.
    void fill(const gl::Framebuffer& target, const gl::Texture& texture, const gl::TexelRect& part,
              Vec2i origin) const;

    RegularLattice m_lattice;
    int m_margin, m_cell, m_texel_size, m_layers;
    float m_radius;  ///< pixels, of a filter that gathers
    Vec2i m_origin;
    bool m_empty = false;  ///< m_radiance is nothing throughout
    gl::Texture m_radiance, m_depth, m_mean, m_rows, m_pixels;
    gl::Framebuffer m_radiance_target, m_rows_target, m_pixels_target;
    gl::Texture m_surfaces;  ///< made at the first begin_surfaces()
    gl::Framebuffer m_surfaces_target;
    gl::Program m_filter_x, m_filter_y;  ///< of a lattice
    gl::Program m_gather;                ///< of a rotated lattice or of samples anywhere
    gl::Buffer m_table;                  ///< their weights
    gl::Texture m_center_depths;         ///< made at the first center_depths()
    gl::Framebuffer m_center_depths_target;
    gl::Program m_center;
    gl::VertexArray m_no_attributes;
};

}  // namespace granita
