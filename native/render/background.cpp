// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/background.h"

#include <algorithm>
#include <cmath>

#include "hider/raster/raster_hider.h"
#include "render/camera_rays.h"
#include "shade/unsettled.h"

namespace granita {
namespace {

/// Angle of a pixel, radians.
float pixel_spread(const Projection& projection) {
    if (!projection.perspective) return 0.0f;
    return static_cast<float>(1.0 / std::max(projection.scale.x, 1e-9));
}

void add(BackgroundRays& rays, const Projection& p, const Vec3f& direction, Vec2d raster,
         const CameraSample& sample) {
    rays.directions.push_back(direction);
    // They start on the lens.
    if (!p.perspective) rays.rasters.emplace_back(raster + sample.lens * p.lens_radius * p.scale);
}

/// Colours at the corners of a tile's pixels, [17][17].
class PixelCorners {
  public:
    PixelCorners(const Camera& camera, const CameraRays& tile, const ShadingSystem& shading) {
        BackgroundRays rays{.spread = pixel_spread(camera.projection)};
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const Vec2d raster = tile.raster(x, y);
                add(rays, camera.projection, tile.direction(raster, {}), raster, {});
            }
        shading.background(rays, m_colors);
    }

    /// Whether what is between the pixel's corners bends by less than the threshold
    /// (shade/unsettled.h), as far as they tell.
    bool settled(int pixel, float threshold) const {
        const Vec3f* c = of(pixel % kTileSize, pixel / kTileSize);
        const auto apart = [&](int a, int b) {
            return displayed_difference(c[a], c[b]) > threshold;
        };
        return !apart(0, 1) && !apart(0, kSide) && !apart(0, kSide + 1) && !apart(1, kSide);
    }

    /// Bilinear, at a place in the tile.
    Vec3f at(float x, float y) const {
        const int column = std::clamp(static_cast<int>(x), 0, kTileSize - 1);
        const int row = std::clamp(static_cast<int>(y), 0, kTileSize - 1);
        const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
        const Vec3f* c = of(column, row);
        return glm::mix(glm::mix(c[0], c[1], fx), glm::mix(c[kSide], c[kSide + 1], fx), fy);
    }

  private:
    static constexpr int kSide = kTileSize + 1;
    const Vec3f* of(int column, int row) const {
        return &m_colors[static_cast<std::size_t>(row) * kSide + column];
    }
    std::vector<Vec3f> m_colors;
};

}  // namespace

std::vector<Vec3f> tile_background(const Camera& camera, const SampleTable& table,
                                   const ShadingSystem& shading, const Vec3f& constant,
                                   const TileStore& store,
                                   const std::function<bool(SurfaceId)>& shows) {
    if (shading.background_is_constant()) return {constant};
    std::vector<std::size_t> uncovered;
    for (std::size_t i = 0; i < store.id.size(); ++i)
        if (store.id[i] == kNoSurface || (shows && shows(store.id[i]))) uncovered.push_back(i);
    if (uncovered.empty()) return {constant};

    // The hider may have met no motion and no lens in this tile; what lies at infinity still has
    // both.
    const SampleNeeds needs{camera.world_from_camera.size() > 1, camera.projection.has_lens()};
    TileSamples samples;
    table.fill_tile(store.tile, needs, samples);
    const CameraRays tile(camera, store, samples);
    std::vector<Vec3f> colors(store.id.size(), Vec3f(0.0f));
    // A static pinhole camera sees a function of the pixel that is smooth but for what the world
    // draws: a sun, a horizon.  Pixels' corners miss
    // patterns: of stars of a tenth of a pixel they showed a tenth.
    if (!tile.vary_in_pixel() && !shading.background_is_patterned()) {
        const PixelCorners corners(camera, tile, shading);
        for (const std::size_t i : uncovered) colors[i] = corners.at(samples.x[i], samples.y[i]);
        const auto count = static_cast<std::size_t>(samples.samples);
        std::erase_if(uncovered, [&](std::size_t i) {
            return corners.settled(static_cast<int>(i / count), shading.threshold());
        });
    }
    BackgroundRays wanted{.spread = pixel_spread(camera.projection)};
    std::vector<Vec3f> found;
    wanted.directions.reserve(uncovered.size());
    for (const std::size_t i : uncovered) {
        const Vec2d raster = tile.raster(i);
        const CameraSample sample = tile.sample(i);
        add(wanted, camera.projection, tile.direction(raster, sample), raster, sample);
    }
    shading.background(wanted, found);
    for (std::size_t k = 0; k < uncovered.size(); ++k) colors[uncovered[k]] = found[k];
    return colors;
}

std::vector<Vec3f> corner_background(const Camera& camera, const ShadingSystem& shading,
                                     const Rect& pixels, const RasterPass& pass) {
    const CameraSample sample{pass.t, {pass.u, pass.v}, pass.inverse_focus};
    const Projection& p = camera.projection;
    const Mat4d world_from_camera = CameraPath(camera).world_from_camera(sample.t);
    BackgroundRays rays{.spread = pixel_spread(p)};
    std::vector<Vec3f> colors;
    for (int y = pixels.y0; y <= pixels.y1; ++y)
        for (int x = pixels.x0; x <= pixels.x1; ++x)
            add(rays, p, world_direction(p, world_from_camera, {x, y}, sample), {x, y}, sample);
    shading.background(rays, colors);
    return colors;
}

}  // namespace granita
