// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/background.h"

#include <algorithm>
#include <cmath>

#include "hider/raster/raster_hider.h"

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

/// When and from which point of the unit lens a sample looks.
struct Look {
    double t = 0.0;
    Vec2d lens{0.0};
    double inverse_focus = 0.0;
};

/// World direction through a raster position (pixels): a point at infinity obeys X = cx + sx (slope
/// + lx / focus) (math/projection.h with z -> infinity).
Vec3f world_direction(const Camera& camera, Vec2d raster, const Look& look) {
    const Projection& p = camera.projection;
    Vec3d direction(0.0, 0.0, 1.0);
    if (p.perspective) {
        direction.x = (raster.x - p.center.x) / p.scale.x;
        direction.y = (raster.y - p.center.y) / p.scale.y;
        direction -= Vec3d(look.lens, 0.0) * (p.lens_radius * look.inverse_focus);
    }
    return Vec3f(glm::normalize(rotation_at(camera, look.t) * direction));
}

/// Angle of a pixel, radians.
float pixel_spread(const Camera& camera) {
    return static_cast<float>(1.0 / std::max(camera.projection.scale.x, 1e-9));
}

class Directions {
  public:
    Directions(const Camera& camera, const TileStore& store, const TileSamples& samples)
        : m_camera(camera), m_samples(samples), m_origin(Vec2d(store.tile * kTileSize)) {}

    bool vary_in_pixel() const {
        return !m_samples.u.empty() ||
               (!m_samples.t.empty() && m_camera.world_from_camera.size() > 1);
    }

    /// World direction through a tile position (pixels).
    Vec3f at(double x, double y, const Look& look) const {
        return world_direction(m_camera, {m_origin.x + x, m_origin.y + y}, look);
    }

    Vec3f of_sample(std::size_t i) const {
        Look look;
        if (!m_samples.t.empty()) look.t = m_samples.t[i];
        if (!m_samples.u.empty()) {
            look.lens = {m_samples.u[i], m_samples.v[i]};
            look.inverse_focus = m_samples.inverse_focus.empty() ? 1.0 / m_camera.projection.focus
                                                                 : m_samples.inverse_focus[i];
        }
        return at(m_samples.x[i], m_samples.y[i], look);
    }

  private:
    const Camera& m_camera;
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
        for (int x = 0; x < kCorners; ++x) corner_directions.push_back(directions.at(x, y, {}));
    std::vector<Vec3f> corners;
    shading.background(corner_directions, spread, corners);

    std::vector<Vec3f> colors(samples.x.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const int x = std::clamp(static_cast<int>(samples.x[i]), 0, kTileSize - 1);
        const int y = std::clamp(static_cast<int>(samples.y[i]), 0, kTileSize - 1);
        const float fx = samples.x[i] - static_cast<float>(x),
                    fy = samples.y[i] - static_cast<float>(y);
        const Vec3f* c = &corners[static_cast<std::size_t>(y) * kCorners + x];
        colors[i] =
            glm::mix(glm::mix(c[0], c[1], fx), glm::mix(c[kCorners], c[kCorners + 1], fx), fy);
    }
    return colors;
}

}  // namespace

std::vector<Vec3f> tile_background(const Camera& camera, const SampleTable& table,
                                   const ShadingSystem& shading, const Vec3f& constant,
                                   const TileStore& store) {
    if (shading.background_is_constant()) return {constant};
    std::vector<std::size_t> uncovered;
    for (std::size_t i = 0; i < store.id.size(); ++i)
        if (store.id[i] == kNoSurface) uncovered.push_back(i);
    if (uncovered.empty()) return {constant};

    // The hider may have met no motion and no lens in this tile; what lies at infinity still has
    // both.
    const SampleNeeds needs{camera.world_from_camera.size() > 1, camera.projection.has_lens()};
    TileSamples samples;
    table.fill_tile(store.tile, needs, samples);
    const Directions directions(camera, store, samples);
    const float spread = pixel_spread(camera);
    if (!directions.vary_in_pixel()) return from_corners(directions, shading, spread, samples);

    std::vector<Vec3f> wanted, found;
    wanted.reserve(uncovered.size());
    for (const std::size_t i : uncovered) wanted.push_back(directions.of_sample(i));
    shading.background(wanted, spread, found);
    std::vector<Vec3f> colors(store.id.size(), Vec3f(0.0f));
    for (std::size_t k = 0; k < uncovered.size(); ++k) colors[uncovered[k]] = found[k];
    return colors;
}

std::vector<Vec3f> corner_background(const Camera& camera, const ShadingSystem& shading,
                                     const Rect& pixels, const RasterPass& pass) {
    const Look look{pass.t, {pass.u, pass.v}, pass.inverse_focus};
    std::vector<Vec3f> directions, colors;
    for (int y = pixels.y0; y <= pixels.y1; ++y)
        for (int x = pixels.x0; x <= pixels.x1; ++x)
            directions.push_back(world_direction(camera, {x, y}, look));
    shading.background(directions, pixel_spread(camera), colors);
    return colors;
}

}  // namespace granita
