// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hider/micropolygon.h"
#include "hider/resolve/surface_groups.h"
#include "hider/sample_store.h"
#include "hider/samples/sample_order.h"
#include "hider/samples/sample_table.h"
#include "math/projection.h"

namespace granita {

/// Three vertices of a grid and their weights: where a sample meets a micropolygon.
struct SurfacePoint {
    const Grid* grid = nullptr;
    int vertex[3] = {0, 0, 0};
    float weight[3] = {1.0f, 0.0f, 0.0f};

    /// From the first corner on, so that what is constant comes out as it is.
    Vec3f operator()(const std::vector<Vec3f>& values) const {
        const Vec3f& first = values[vertex[0]];
        return first + weight[1] * (values[vertex[1]] - first) +
               weight[2] * (values[vertex[2]] - first);
    }
};

/// Where a sample meets the fragment's micropolygon.
SurfacePoint point_of(const Fragment& fragment, const GridPool& pool);

/// The vertices of a micropolygon.
struct SurfaceCorners {
    const Grid* grid = nullptr;
    int vertex[4] = {};
};

/// A micropolygon in one segment of its motion, in a tile's homogeneous raster space.
struct SurfaceRecord {
    SurfaceId id = kNoSurface;
    int segment = 0, segments = 0;  ///< segments 0 = static
    SurfaceCorners corners;
    Corner<float> begin[4], delta[4];
    bool colored = false;   ///< light that a sample takes as it is: no holdout, and shaded
    bool constant = false;  ///< of one colour, wherever it is met
    Vec3f radiance[4];      ///< of a coloured one
};

/// Where a micropolygon is at its knots from one segment to another, a corner after another, in a
/// tile's homogeneous raster space.
struct SurfaceKnots {
    int first = 0, last = 0;        ///< segments
    std::vector<float> x, y, w, z;  ///< [last - first + 2][4]; a knot less without motion
};

/// Where kCount samples in a row meet their surfaces.  Bit or element i: sample first + i.
struct SurfaceRun {
    static constexpr int kCount = kPacket;

    std::uint32_t seen = 0;     ///< see any surface
    std::uint32_t plain = 0;    ///< known here; the others that see anything need locate()
    std::uint32_t colored = 0;  ///< SurfaceRecord::colored
    alignas(64) float color[3][kCount] = {};  ///< of coloured ones; else anything

    // Where points are wanted.
    bool wants_points = false;
    std::uint32_t second = 0;  ///< triangle (0, 2, 3)
    alignas(64) float weight[3][kCount];
    SurfaceCorners corners[kCount];

    SurfacePoint point(int lane) const;
};

/// Finds again where the samples of one tile meet the surfaces that the hider stored, with the
/// hider's own arithmetic.  A sample that rounding puts outside takes the nearest point inside.
class SurfaceInterpolator {
  public:
    /// `shaded`: grids may be asked for their colours. Before shading, another bucket may be
    /// writing them.
    SurfaceInterpolator(const Projection& projection, Vec2i tile, const TileSamples& samples,
                        const GridPool& pool, bool shaded = true);
    ~SurfaceInterpolator();
    SurfaceInterpolator(const SurfaceInterpolator&) = delete;
    SurfaceInterpolator& operator=(const SurfaceInterpolator&) = delete;
    SurfacePoint locate(std::uint32_t sample, SurfaceId id);
    /// The same as a fragment of this depth key.
    Fragment fragment(std::uint32_t sample, SurfaceId id, float key);
    /// The same bits for SurfaceRun::kCount samples from `first` on, as far as `plain` says.
    /// `points`: SurfaceRun::point() will be asked.
    void locate_run(std::uint32_t first, const SurfaceId* ids, bool points, SurfaceRun& out);

    /// The colours of what locate_run() calls plain and coloured, surface by surface: the same
    /// bits. Sets done[sample] to 1; leaves the depth.
    /// @param colors,done [samples of the tile].
    void color_groups(const SurfaceGroups& groups, SampleColors& colors,
                      std::span<std::uint8_t> done);

    /// The colours alone, not where it is.  Stays until the next call.
    SurfaceRecord& load_colors(SurfaceId id);
    /// Stays until the next call.
    const SurfaceRecord& load(SurfaceId id, float time);
    Vec2f lens() const { return m_lens; }  ///< lens radius times pixels per unit shear
    float inverse_focus() const { return m_inverse_focus; }  ///< where samples have none

  private:
    /// The corners from which a sample is seen through the lens, at its time.
    struct Seen {
        const SurfaceRecord* surface;
        Corner<float> corners[4];
        Offset<float> offsets[4];
    };
    void open_cache();
    void load_corners(SurfaceRecord& record, int segment) const;
    void fill_colors(SurfaceId id, SurfaceRecord& record) const;
    void load_knots(const SurfaceRecord& record, std::span<const float> times);
    Seen see(std::uint32_t sample, SurfaceId id);
    void weigh(const Seen& seen, bool& second, float weight[3]) const;

    Projection m_projection;
    Vec2d m_origin;
    const TileSamples& m_samples;
    const GridPool& m_pool;
    bool m_shaded;
    float m_inverse_focus;
    Vec2f m_lens;
    static constexpr std::size_t kCached = 256;
    SurfaceKnots m_knots;
    /// By id, once it is asked: neighbouring samples ask for the same few.
    std::vector<SurfaceRecord> m_cache;
};

}  // namespace granita
