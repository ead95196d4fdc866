// SPDX-License-Identifier: GPL-3.0-or-later
// The raster executor: the paper's hider through OpenGL (Wexler, Gritz, Enderton and Rice 2005,
// sections 9.3.3 to 9.3.6).
//
//   RasterHider hider(gl_thread, frame);
//   auto bucket = hider.open(pixels, grids);      // positions and opacity to the device, once
//   seen = bucket->find_seen();                   // before shading
//   ... shade the grids with seen[i] ...
//   image = bucket->render(background);           // draw supersampled, filter, read back
//
// Samples are those of SampleTable.  REGULAR: the lattice's cell centres are the centres of the
// target's texels, and each pass has one time and one lens point for all pixels.  What a sample
// sees is what the CPU executors see, but for samples within a unit of OpenGL's sub-pixel grid
// (2^-8 texel in most drivers) of an edge, and depths within the rounding of its depth
// interpolation.  INDEPENDENT and INTERLEAVED (RasterFrame::table): the paper's per-pixel time
// sampling (9.3.5, figure 9.6): each triangle is drawn as a quadrilateral around its whole way, and
// the fragment program tests each sample at its own place, time and lens point, with the CPU's
// arithmetic.  No bit depends on `pixels`.
//
// Differs from the paper: grids are tested against the finished depth buffer of the bucket instead
// of what happens to be drawn so far, and not by one occlusion query each: the samples themselves
// mark the grids that they see.  That costs one more pass over the geometry, needs no order, finds
// exactly what is seen, makes tiny grids no dearer than large ones, and leaves nothing to wait for.
//
// Any thread may call, one at a time for a bucket.  What OpenGL does is done on the thread that
// owns it; the arrays that it takes are made, and what comes back is taken over, on the caller's.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/report.h"
#include "base/statistics.h"
#include "dice/grid.h"
#include "gl/gl_thread.h"
#include "hider/grid_sweep.h"
#include "hider/raster/raster_filter.h"
#include "hider/raster/raster_target.h"
#include "hider/samples/sample_table.h"
#include "math/projection.h"
#include "scene/scene.h"

namespace granita {

/// Shutter time in [0, 1] and place on the unit lens of all samples of one pass, and 1 / the focus
/// distance then.
struct RasterPass {
    float t = 0.0f, u = 0.0f, v = 0.0f, inverse_focus = 0.0f;
};
/// Those of a REGULAR table.
std::vector<RasterPass> raster_passes(const SampleTable& table, SampleNeeds needs,
                                      const Projection& projection);

struct RasterFrame {
    Projection projection;
    RasterFilter filter;                ///< also says the lattice
    std::vector<RasterPass> passes{1};  ///< at least one
    /// Not REGULAR: places, times and lens points of all samples, in one pass; `filter` gathers.
    const SampleTable* table = nullptr;
    SampleNeeds needs;               ///< of `table`
    bool lifespans = false;          ///< some grids do not exist throughout the shutter
    float opacity_threshold = 1.0f;  ///< as CompositeSettings::opacity_threshold
    bool film_transparent = true;    ///< alpha is what surfaces cover
    int z_batch_size = 26;           ///< transparent grids that are peeled together
    int most_layers =
        8;  ///< passes drawn at once, where the device can; 1 = multipass accumulation
    int most_targets = 8;  ///< that a draw fills; with fewer than 4 a layer is peeled in 3 passes
    /// find_seen() asks what saturated samples hide, too: transparent grids are peeled twice.
    bool cull_saturated = true;
    Statistics* statistics = nullptr;
    /// Where dropped micropolygons are named; both or neither.
    const Scene* scene = nullptr;
    Report* report = nullptr;
};

/// [height][width] premultiplied linear RGBA, filtered; lower-left pixel first.
struct RasterImage {
    Rect pixels;
    std::vector<Vec4f> combined;
};

/// What each sample of a rectangle sees in one pass, [height][width][cells of the lattice],
/// lower-left pixel first: the nearest surface, opaque or not.
struct RasterSurfaces {
    struct Surface {
        std::int32_t grid = -1;  ///< index in the list given to open(); -1 = nothing
        std::int32_t micropolygon = -1;
    };
    Rect pixels;
    std::vector<Surface> surface;
    std::vector<float> key;  ///< Projection::depth_key of the surface; -inf = nothing
};

/// One bucket's grids on the device.  The grids must outlive it, their sweeps need not; must not
/// outlive its hider.
class RasterBucket {
  public:
    virtual ~RasterBucket() = default;
    /// For each grid of open() whether a sample, the filter's margin included, sees it in any pass.
    /// Transparent ones count as seen where they lie before the opaque.
    virtual std::vector<bool> find_seen() = 0;
    /// Every grid must be shaded, but for those that find_seen() found unseen.
    virtual RasterImage render(const RasterBackground& background = {}) = 0;
    /// Depth keys of the samples nearest to the pixels' centres, in the first pass,
    /// [height][width]; -inf = nothing.
    virtual std::vector<float> center_keys() = 0;
    /// Reads the supersampled target back, for tests.
    virtual RasterSurfaces surfaces(int pass = 0) = 0;
};

class RasterHider {
  public:
    /// Throws GlError where the filter needs more than the device has.
    RasterHider(gl::GlThread& thread, const RasterFrame& frame);
    ~RasterHider();
    RasterHider(const RasterHider&) = delete;
    RasterHider& operator=(const RasterHider&) = delete;

    const RasterFrame& frame() const { return m_frame; }
    /// `pixels` of the frame, grown by the filter: what overlaps it belongs to the bucket.
    Rect sample_pixels(const Rect& pixels) const;
    /// Opacity must be there where it varies.  Non-finite micropolygons are left out, counted
    /// (Counter::MicropolygonsDropped) and reported.
    std::unique_ptr<RasterBucket> open(const Rect& pixels,
                                       std::span<const GridSweep* const> sweeps);
    /// Grids that no other bucket asks for.
    std::unique_ptr<RasterBucket> open(const Rect& pixels, const std::vector<const Grid*>& grids);

  private:
    class Bucket;
    gl::GlThread& m_thread;
    RasterFrame m_frame;
    std::unique_ptr<class RasterDevice> m_device;
};

}  // namespace granita
