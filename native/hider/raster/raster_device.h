// SPDX-License-Identifier: GPL-3.0-or-later
// What all buckets of the raster executor share on the device, and how grids are drawn with it.
#pragma once

#include <optional>
#include <vector>

#include "gl/buffer.h"
#include "gl/egl_context.h"
#include "gl/program.h"
#include "gl/vertex_array.h"
#include "hider/raster/raster_hider.h"
#include "hider/raster/raster_output.h"
#include "hider/raster/raster_peel.h"
#include "hider/raster/raster_samples.h"
#include "hider/raster/raster_seen.h"
#include "hider/raster/raster_target.h"

namespace granita {

/// A bucket's grids on the device: uploaded once, drawn in every pass (paper, 9.3.5).
struct RasterBuffers {
    gl::Buffer positions, grids, vertex_grids, indices, radiance, opacity;
    gl::VertexArray array;
};

/// Consecutive time and lens passes that are drawn at once, a layer of the target each.
struct RasterPasses {
    int first = 0, count = 1;
    bool still = false;  ///< nothing moves in the cell: all passes see what the first one sees
};

/// Used on the thread that owns OpenGL.
class RasterDevice {
  public:
    RasterDevice(const RasterFrame& frame, const gl::ContextInfo& info);

    /// Before anything else is asked for the cell.
    void begin(const RasterCell& cell);
    static bool reaches(const RasterBounds& bounds, const RasterCell& cell);
    /// Draws of ranges, as OpenGL reads them: in ascending order, each only in the layers whose
    /// instants it touches the cell at and is seen; with samples(), one instance a segment of the
    /// motion.
    struct Command {
        GLuint count, instances, first_index, base_vertex, first_instance;
    };
    std::vector<Command> commands(const RasterGeometry& geometry,
                                  const std::vector<RasterGeometry::Range>& ranges,
                                  const std::vector<std::uint32_t>& among, const RasterCell& cell,
                                  const RasterPasses& passes, const RasterSeen& seen) const;
    /// Into the target that is bound.
    void draw(RasterOutput output, const RasterBuffers& buffers,
              const std::vector<Command>& commands, const RasterCell& cell,
              const RasterPasses& passes);
    /// Adds what was drawn to the mean of the passes before, and leaves its colour empty.
    void accumulate(const RasterCell& cell, const RasterPasses& passes, bool peeled,
                    const RasterBackground& background, const gl::Buffer& corners);
    /// Marks in `seen` the grids that `names` has, but for samples that peeling has saturated where
    /// `but_saturated`.
    void mark_names(const gl::Texture& names, bool but_saturated, const RasterCell& cell,
                    const RasterPasses& passes, const RasterBuffers& buffers,
                    const gl::Buffer& seen) const;
    /// Binds what RasterOutput::Mark reads and writes.
    void begin_marks(const RasterCell& cell, const gl::Buffer& seen) const;

    RasterTarget& target() { return m_target; }
    /// nullptr: all samples of a pass have one time and one lens point.
    const RasterSamples* samples() const { return m_samples ? &*m_samples : nullptr; }
    /// Made when the first transparent grid comes.
    RasterPeel& peel();
    /// Depth is near / z: the far clip is a depth that the target starts with.
    float farthest() const;

  private:
    gl::Program& program(RasterOutput output);
    gl::Program make_program(RasterOutput output) const;
    double lattice_turn() const;
    void set_cell(const RasterCell& cell) const;
    /// For the program in use, which includes raster/marks.glsl.
    void set_marked(const RasterPasses& passes) const;
    void draw_passes(const RasterBuffers& buffers, const std::vector<Command>& commands,
                     const RasterPasses& passes) const;
    /// A quadrilateral around each triangle's way: raster/sample.*.
    void draw_samples(const RasterBuffers& buffers, const std::vector<Command>& commands) const;

    const RasterFrame& m_frame;
    RasterTarget m_target;
    std::optional<RasterSamples> m_samples;
    std::optional<RasterPeel> m_peel;
    std::optional<gl::Program> m_programs[7];
    gl::Program m_accumulate, m_mark;
    gl::Framebuffer m_mark_target;
    gl::Buffer m_passes, m_layers;
};

}  // namespace granita
