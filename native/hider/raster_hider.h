// SPDX-License-Identifier: GPL-3.0-or-later
// The raster executor: the paper's hider for static opaque grids, through OpenGL (Wexler, Gritz,
// Enderton and Rice 2005, sections 9.3.3 and 9.3.6).
//
//   RasterHider hider(gl_thread, frame);
//   auto bucket = hider.open(pixels, grids);      // positions to the device, once
//   visible = bucket->count_visible();            // occlusion queries, before shading
//   ... shade the grids with visible[i] > 0 ...
//   image = bucket->render();                     // draw supersampled, filter, read back
//
// Samples are those of SampleTable with REGULAR sampling: the lattice's cell centres are the
// centres of the target's texels.  What a sample sees is what the CPU executors see, but for
// samples within a unit of OpenGL's sub-pixel grid (2^-8 texel in most drivers) of an edge, and
// depths within the rounding of its depth interpolation.  No bit depends on `pixels`.
//
// Differs from the paper: grids are tested against the finished depth buffer of the bucket instead
// of what happens to be drawn so far.  That costs one more pass over the geometry, needs no order,
// finds exactly what is seen, and leaves no query to wait for until all are under way.
//
// Any thread may call; the work is done on the thread that owns OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/statistics.h"
#include "dice/grid.h"
#include "gl/gl_thread.h"
#include "hider/raster_filter.h"
#include "math/projection.h"

namespace granita {

struct RasterFrame {
    Projection projection;   ///< without lens
    RasterFilter filter;     ///< also says the lattice
    Vec4f background{0.0f};  ///< premultiplied; what a sample sees where there is no surface
    Statistics* statistics = nullptr;
};

/// [height][width] premultiplied linear RGBA, filtered; lower-left pixel first.
struct RasterImage {
    Rect pixels;
    std::vector<Vec4f> combined;
};

/// What each sample of a rectangle sees, [height * lattice][width * lattice], lower-left first.
struct RasterSurfaces {
    struct Surface {
        std::int32_t grid = -1;  ///< index in the list given to open(); -1 = nothing
        std::int32_t micropolygon = -1;
    };
    Rect pixels;
    int lattice = 1;
    std::vector<Surface> surface;
    std::vector<float> key;  ///< Projection::depth_key of the surface; -inf = nothing
};

/// One bucket's grids on the device.  The grids must outlive it; must not outlive its hider.
class RasterBucket {
  public:
    virtual ~RasterBucket() = default;
    /// For each grid of open() the samples, the filter's apron included, that see it.  Grids that
    /// coincide there are counted both.
    virtual std::vector<std::uint64_t> count_visible() = 0;
    /// Every grid must be shaded, but for those that count_visible() found unseen.
    virtual RasterImage render() = 0;
    virtual RasterSurfaces surfaces() = 0;
};

class RasterHider {
  public:
    /// Throws GlError where the filter needs more than the device has, InternalError for a lens.
    RasterHider(gl::GlThread& thread, const RasterFrame& frame);
    ~RasterHider();
    RasterHider(const RasterHider&) = delete;
    RasterHider& operator=(const RasterHider&) = delete;

    /// Static and opaque: the only grids that open() takes.
    static bool can_draw(const Grid& grid) { return !grid.motion && !grid.opacity_varies; }
    /// `pixels` of the frame, grown by the filter: what overlaps it belongs to the bucket.
    Rect sample_pixels(const Rect& pixels) const;
    /// Non-finite micropolygons are left out and counted (Counter::MicropolygonsDropped).
    std::unique_ptr<RasterBucket> open(const Rect& pixels, const std::vector<const Grid*>& grids);

  private:
    struct Device;
    class Bucket;
    gl::GlThread& m_thread;
    RasterFrame m_frame;
    std::unique_ptr<Device> m_device;
};

}  // namespace granita
