// SPDX-License-Identifier: GPL-3.0-or-later
// Where samples look: from their points of the lens, at their times.
#pragma once

#include "hider/sample_store.h"
#include "hider/samples/sample_table.h"
#include "scene/camera_path.h"
#include "shade/rays/ray.h"

namespace granita {

/// When and from which point of the unit lens a sample looks.
struct CameraSample {
    double t = 0.0;
    Vec2d lens{0.0};
    double inverse_focus = 0.0;
};

/// Of one of a tile's.
CameraSample camera_sample_of(const TileSamples& samples, std::size_t i,
                              const Projection& projection);

/// What a sample sees, in camera space: where depth is 0, and the way of a metre of depth.
struct CameraLine {
    Vec3d start, way;
    Vec3d at(double depth) const { return start + way * depth; }
};
CameraLine camera_line(const Projection& projection, Vec2d raster, const CameraSample& sample);

/// World direction through a raster position (pixels): a point at infinity obeys X = cx + sx (slope
/// + lx / focus) (math/projection.h with z -> infinity).
Vec3f world_direction(const Projection& projection, const Mat4d& world_from_camera, Vec2d raster,
                      const CameraSample& sample);

class CameraRays {
  public:
    /// Of a tile, which both must outlive this.
    CameraRays(const Camera& camera, const TileStore& store, const TileSamples& samples)
        : m_projection(camera.projection),
          m_path(camera),
          m_moves(camera.world_from_camera.size() > 1),
          m_samples(samples),
          m_origin(Vec2d(store.tile * kTileSize)) {}

    bool vary_in_pixel() const { return !m_samples.u.empty() || (!m_samples.t.empty() && m_moves); }

    /// Place in the frame, of one in the tile (pixels).
    Vec2d raster(double x, double y) const { return m_origin + Vec2d(x, y); }
    /// Of a sample.
    Vec2d raster(std::size_t i) const { return raster(m_samples.x[i], m_samples.y[i]); }
    CameraSample sample(std::size_t i) const {
        return camera_sample_of(m_samples, i, m_projection);
    }

    /// In the world.
    Vec3f direction(Vec2d raster, const CameraSample& sample) const {
        return world_direction(m_projection, m_path.world_from_camera(sample.t), raster, sample);
    }

    struct Seen {
        Ray ray;        ///< of a sample, from the near plane on, without end
        float stretch;  ///< metres along it a metre of depth
        float near;     ///< depth of its start

        /// How far away on it something of a depth is.
        float distance(float depth) const { return stretch * (depth - near); }
    };
    /// `origin`: of shading space, in the world.
    Seen ray(std::size_t i, const Vec3d& origin, float frame_time) const;

  private:
    const Projection& m_projection;
    CameraPath m_path;
    bool m_moves;
    const TileSamples& m_samples;
    Vec2d m_origin;
};

}  // namespace granita
