// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_peel.h"

#include <algorithm>

#include "gl/gl_check.h"
#include "gl/shader_source.h"
#include "shaders/shared/raster_layout.h"

namespace granita {
namespace {

/// Small grids fill a batch less: it holds at least this many triangles a grid of its size.
constexpr std::uint32_t kTrianglesOfAGrid = 32;

struct Extent {
    std::uint32_t range;
    float nearest, farthest;  ///< depths of OpenGL
};

/// With what the rasterizer may add: it snaps corners, and depth is a plane that goes through them
/// over the whole target.  Mesa's is wrong by up to 1e-3 of the depth on faces of a pixel; a wider
/// margin only keeps a few more samples for the next batch.
Extent extent(const RasterGeometry& geometry, std::uint32_t range, double near_clip) {
    const auto [z_near, z_far] = geometry.depths(geometry.transparent()[range]);
    const double nearest = z_near > near_clip ? near_clip / z_near : 1.0;
    const double farthest = z_far > near_clip ? near_clip / z_far : 1.0;
    const double margin = 0.1 * (nearest - farthest) + 1e-3 * nearest;
    return {range, static_cast<float>(nearest + margin), static_cast<float>(farthest - margin)};
}

}  // namespace

std::vector<ZBatch> z_batches(const RasterGeometry& geometry,
                              const std::vector<std::uint32_t>& among, double near_clip,
                              float farthest, int size) {
    std::vector<Extent> extents;
    extents.reserve(among.size());
    for (const std::uint32_t range : among) extents.push_back(extent(geometry, range, near_clip));
    std::stable_sort(extents.begin(), extents.end(),
                     [](const Extent& a, const Extent& b) { return a.nearest > b.nearest; });
    std::vector<ZBatch> batches;
    std::vector<Extent> active;
    for (std::size_t i = 0; i < extents.size();) {
        int grids = 0;
        std::uint32_t triangles = 0;
        const auto full = [&] {
            return grids >= size && triangles >= kTrianglesOfAGrid * static_cast<unsigned>(size);
        };
        for (; i < extents.size() && !full(); ++i, ++grids) {
            triangles += geometry.transparent()[extents[i].range].index_count / 3;
            active.push_back(extents[i]);
        }
        ZBatch batch;
        batch.farther_than = i < extents.size() ? std::max(farthest, extents[i].nearest) : farthest;
        for (const Extent& e : active) batch.ranges.push_back(e.range);
        std::sort(batch.ranges.begin(), batch.ranges.end());
        std::erase_if(active, [&](const Extent& e) { return e.farthest > batch.farther_than; });
        batches.push_back(std::move(batch));
    }
    return batches;
}

RasterPeel::RasterPeel(const RasterTarget& target, int most_targets) : m_target(target) {
    const int side = target.texel_size(), layers = target.layers();
    const auto texture = [&](GLenum format) { return gl::Texture(format, side, side, layers); };
    m_color = texture(GL_RGBA32F);
    m_transmission = texture(GL_RGBA32F);
    m_peeled_depth = texture(GL_R32F);
    m_peeled_name = texture(GL_R32UI);
    m_radiance = texture(GL_RGBA32F);
    m_opacity = texture(GL_RGBA32F);
    m_name = texture(GL_R32UI);
    m_depth = texture(GL_DEPTH_COMPONENT32F);
    GLint device_targets = 0;
    glGetIntegerv(GL_MAX_DRAW_BUFFERS, &device_targets);
    if (std::min(most_targets, static_cast<int>(device_targets)) >= 4) {
        m_layer_depth = texture(GL_R32F);
        m_outputs = {RasterOutput::Layer};
        m_targets.emplace_back(
            std::vector<const gl::Texture*>{&m_radiance, &m_opacity, &m_name, &m_layer_depth},
            &m_depth);
    } else {
        m_outputs = {RasterOutput::LayerName, RasterOutput::LayerRadiance,
                     RasterOutput::LayerOpacity};
        m_targets.emplace_back(&m_name, &m_depth);
        m_targets.emplace_back(&m_radiance, nullptr);
        m_targets.emplace_back(&m_opacity, nullptr);
    }
    m_composite =
        gl::Program("layers", {{GL_COMPUTE_SHADER, gl::shader_source("raster/composite.comp")}});
}

void RasterPeel::begin(const RasterCell& cell) const {
    constexpr float kZero[4] = {}, kClear[4] = {1.0f, 1.0f, 1.0f, 0.0f}, kBeforeAll = 2.0f;
    constexpr GLuint kNone = 0;
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    m_color.clear(cell.texels, kZero);
    m_transmission.clear(cell.texels, kClear);
    m_peeled_depth.clear(cell.texels, &kBeforeAll);
    m_peeled_name.clear(cell.texels, &kNone);
}

void RasterPeel::begin_layer(const RasterCell& cell, float farther_than) const {
    constexpr GLuint kNone = 0;
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    const gl::Framebuffer& first = m_targets.front();
    m_target.bind(first, cell);
    glClearNamedFramebufferuiv(first.name(), GL_COLOR, m_targets.size() == 1 ? 2 : 0, &kNone);
    glClearNamedFramebufferfv(first.name(), GL_DEPTH, 0, &farther_than);
}

void RasterPeel::begin_output(RasterOutput output, const RasterCell& cell) const {
    const auto i = static_cast<std::size_t>(std::find(m_outputs.begin(), m_outputs.end(), output) -
                                            m_outputs.begin());
    m_target.bind(m_targets[i], cell);
    if (i > 0) {
        glDisable(GL_DEPTH_TEST);
        m_name.bind(RASTER_LAYER_NAME);
        m_depth.bind(RASTER_LAYER_DEPTH);
        return;
    }
    m_target.depth().bind(RASTER_OPAQUE_DEPTH);
    m_peeled_depth.bind(RASTER_PEELED_DEPTH);
    m_peeled_name.bind(RASTER_PEELED_NAME);
}

void RasterPeel::composite(const RasterCell& cell, int layers, float threshold) const {
    m_radiance.bind(0);
    m_opacity.bind(1);
    m_name.bind(2);
    (m_outputs.size() == 1 ? m_layer_depth : m_depth).bind(3);
    m_color.bind_image(0, GL_READ_WRITE);
    m_transmission.bind_image(1, GL_READ_WRITE);
    m_peeled_depth.bind_image(2, GL_WRITE_ONLY);
    m_peeled_name.bind_image(3, GL_WRITE_ONLY);
    m_composite.use();
    glUniform1f(RASTER_THRESHOLD, threshold);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    m_target.dispatch(cell, layers);
    gl::check("compositing a layer");
}

void RasterPeel::bind_result() const {
    m_color.bind(1);
    m_transmission.bind(2);
    m_peeled_depth.bind(3);
}

}  // namespace granita
