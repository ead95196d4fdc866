// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/background.h"

#include <algorithm>
#include <cmath>

namespace granita {
namespace {

/// world_from_camera's rotation at shutter time t, between its knots.
Mat3d rotation_at(const Camera& camera, double t) {
    const auto& knots = camera.world_from_camera;
    const double at = t * static_cast<double>(knots.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(at), knots.size() - 1);
    const auto next = std::min(k + 1, knots.size() - 1);
    const double f = at - static_cast<double>(k);
    return Mat3d(knots[k]) * (1.0 - f) + Mat3d(knots[next]) * f;
}

class Directions {
  public:
    Directions(const Camera& camera, const TileStore& store, const TileSamples& samples)
        : m_camera(camera),
          m_projection(camera.projection),
          m_samples(samples),
          m_origin(Vec2d(store.tile * kTileSize)) {}

    bool vary_in_pixel() const {
        return !m_samples.u.empty() ||
               (!m_samples.t.empty() && m_camera.world_from_camera.size() > 1);
    }

    /// World direction through a tile position (pixels), at time t, from a lens point in the unit
    /// disc: a point at infinity obeys X = cx + sx (slope + lx / focus) (math/projection.h with z
    /// -> infinity).
    Vec3f at(double x, double y, double t, double u, double v) const {
        Vec3d direction(0.0, 0.0, 1.0);
        if (m_projection.perspective) {
            direction.x = (m_origin.x + x - m_projection.center.x) / m_projection.scale.x;
            direction.y = (m_origin.y + y - m_projection.center.y) / m_projection.scale.y;
            if (m_projection.has_lens())
                direction -= Vec3d(u, v, 0.0) * (m_projection.lens_radius / m_projection.focus);
        }
        return Vec3f(glm::normalize(rotation_at(m_camera, t) * direction));
    }

    Vec3f of_sample(std::size_t i) const {
        return at(m_samples.x[i], m_samples.y[i], m_samples.t.empty() ? 0.0 : m_samples.t[i],
                  m_samples.u.empty() ? 0.0 : m_samples.u[i],
                  m_samples.v.empty() ? 0.0 : m_samples.v[i]);
    }

  private:
    const Camera& m_camera;
    const Projection& m_projection;
    const TileSamples& m_samples;
    Vec2d m_origin;
};

/// One evaluation a pixel corner, bilinear between: a static pinhole camera sees a smooth function
/// of the pixel.
std::vector<Vec3f> from_corners(const Directions& directions, const ShadingSystem& shading,
                                float spread, const TileSamples& samples) {
    constexpr int kCorners = kTileSize + 1;
    std::vector<Vec3f> corner_directions;
    for (int y = 0; y < kCorners; ++y)
        for (int x = 0; x < kCorners; ++x)
            corner_directions.push_back(directions.at(x, y, 0.0, 0.0, 0.0));
    std::vector<Vec3f> corners;
    shading.background(corner_directions, spread, corners);

    std::vector<Vec3f> colors(samples.x.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const int x = std::clamp(static_cast<int>(samples.x[i]), 0, kTileSize - 1);
        const int y = std::clamp(static_cast<int>(samples.y[i]), 0, kTileSize - 1);
        const float fx = samples.x[i] - static_cast<float>(x),
                    fy = samples.y[i] - static_cast<float>(y);
        const Vec3f* c = &corners[static_cast<std::size_t>(y * kCorners + x)];
        colors[i] =
            glm::mix(glm::mix(c[0], c[1], fx), glm::mix(c[kCorners], c[kCorners + 1], fx), fy);
    }
    return colors;
}

}  // namespace

std::vector<Vec3f> tile_background(const Camera& camera, const SampleTable& table,
                                   const ShadingSystem& shading, const Vec3f& constant,
                                   const TileStore& store) {
    std::vector<std::size_t> uncovered;
    for (std::size_t i = 0; i < store.id.size(); ++i)
        if (store.id[i] == kNoSurface) uncovered.push_back(i);
    if (uncovered.empty() || shading.background_is_constant()) return {constant};

    // The hider may have met no motion and no lens in this tile; what lies at infinity still has
    // both.
    const SampleNeeds needs{camera.world_from_camera.size() > 1, camera.projection.has_lens()};
    TileSamples samples;
    table.fill_tile(store.tile, needs, samples);
    const Directions directions(camera, store, samples);
    const auto spread = static_cast<float>(1.0 / std::max(camera.projection.scale.x, 1e-9));
    if (!directions.vary_in_pixel()) return from_corners(directions, shading, spread, samples);

    std::vector<Vec3f> wanted, found;
    wanted.reserve(uncovered.size());
    for (const std::size_t i : uncovered) wanted.push_back(directions.of_sample(i));
    shading.background(wanted, spread, found);
    std::vector<Vec3f> colors(store.id.size(), Vec3f(0.0f));
    for (std::size_t k = 0; k < uncovered.size(); ++k) colors[uncovered[k]] = found[k];
    return colors;
}

}  // namespace granita
