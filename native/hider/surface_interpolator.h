// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hider/micropolygon.h"
#include "hider/sample_store.h"
#include "hider/sample_table.h"
#include "math/projection.h"

namespace granita {

/// Three vertices of a grid and their weights: where a sample meets a micropolygon.
struct SurfacePoint {
    const Grid* grid = nullptr;
    int vertex[3] = {0, 0, 0};
    float weight[3] = {1.0f, 0.0f, 0.0f};

    Vec3f operator()(const std::vector<Vec3f>& values) const {
        return weight[0] * values[vertex[0]] + weight[1] * values[vertex[1]] +
               weight[2] * values[vertex[2]];
    }
};

/// Finds again where the samples of one tile meet the surfaces that the hider stored, with the
/// hider's own arithmetic.  A sample that rounding puts outside takes the nearest point inside.
class SurfaceInterpolator {
  public:
    SurfaceInterpolator(const Projection& projection, Vec2i tile, const TileSamples& samples,
                        const GridPool& pool);
    SurfacePoint locate(std::uint32_t sample, SurfaceId id);
    /// The same for `count` <= LocateLanes::kCount samples from `first` on; those without a surface
    /// are left as they are.
    void locate_run(std::uint32_t first, int count, const SurfaceId* ids, SurfacePoint* points);

  private:
    /// A micropolygon in one segment of its motion.
    struct Loaded {
        SurfaceId id = kNoSurface;
        int segment = 0;
        const Grid* grid = nullptr;
        int vertex[4] = {};
        Corner<float> begin[4], delta[4];
    };
    /// The corners from which a sample is seen through the lens, at its time.
    struct Seen {
        const Loaded* surface;
        Corner<float> corners[4];
        Offset<float> offsets[4];
    };
    const Loaded& load(SurfaceId id, float time);
    Seen see(std::uint32_t sample, SurfaceId id);

    Projection m_projection;
    Vec2d m_origin;
    const TileSamples& m_samples;
    const GridPool& m_pool;
    float m_inverse_focus, m_lens_x, m_lens_y;
    std::vector<Loaded> m_cache;  ///< by id; neighbouring samples ask for the same few
};

}  // namespace granita
