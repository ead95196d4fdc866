// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_target.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "gl/gl_check.h"
#include "gl/shader_source.h"
#include "hider/raster/raster_samples.h"
#include "shaders/shared/raster_layout.h"

namespace granita {
namespace {

constexpr int kLargestCell = 64;  ///< pixels; the margin's share falls with it, memory grows
constexpr int kSmallestCell = 16;
constexpr int kWantedTexels = 2048;  ///< side: 64 MiB of colour and 16 of depth
/// Of all layers together: a texel takes 24 bytes, and 80 more where things are transparent.
constexpr int kLayeredTexels = 1 << 21;

int choose_cell(const RasterFilter& filter, int max_texture_size) {
    const auto side = [&](int cell) {
        const int pixels = cell + 2 * filter.margin();
        return filter.lattice.texels_of({0, 0, pixels, pixels}).width();
    };
    int cell = kLargestCell;
    while (cell > kSmallestCell && side(cell) > std::min(kWantedTexels, max_texture_size))
        cell /= 2;
    if (side(cell) > max_texture_size)
        throw GlError("the pixel filter needs a target of " + std::to_string(side(cell)) +
                      " texels a side, the device offers " + std::to_string(max_texture_size));
    return cell;
}

gl::Program screen_program(const std::string& name, const std::string& fragment,
                           const gl::Defines& defines) {
    return gl::Program(name, {{GL_VERTEX_SHADER, gl::shader_source("resolve/screen.vert")},
                              {GL_FRAGMENT_SHADER, gl::shader_source(fragment, defines)}});
}

gl::Program filter_program(const RasterFilter& filter, const std::string& axis) {
    const gl::Defines defines{{"TAP_COUNT", std::to_string(filter.weights.size())},
                              {"TAP_FIRST", std::to_string(filter.first)},
                              {"LATTICE", std::to_string(filter.lattice.side)},
                              {"AXIS", axis}};
    return screen_program("pixel filter along " + axis, "resolve/filter.frag", defines);
}

gl::Program gather_program(const RasterFilter& filter) {
    const gl::Defines defines{{"FACTOR_COUNT", std::to_string(filter.factor.size() - 1)},
                              {"IS_BOX", filter.is_box ? "1" : "0"},
                              {"MARGIN", std::to_string(filter.margin())}};
    return screen_program("pixel filter", "resolve/gather.frag", defines);
}

std::string vector_source(Vec2i v) {
    return "ivec2(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ")";
}

int floor_to(int value, int step) {
    return (value >= 0 ? value : value - step + 1) / step * step;
}

}  // namespace

RasterTarget::RasterTarget(const RasterFilter& filter, int most_layers, int max_texture_size)
    : m_lattice(filter.lattice),
      m_margin(filter.margin()),
      m_cell(choose_cell(filter, max_texture_size)),
      m_radius(static_cast<float>(filter.radius)) {
    const Rect whole = m_lattice.texels_of({0, 0, pixel_size(), pixel_size()});
    m_origin = {-whole.x0, -whole.y0};
    m_texel_size = whole.width();
    const int side = texel_size();
    const int most = std::clamp(kLayeredTexels / (side * side), 1, most_layers);
    const int draws = (most_layers + most - 1) / most;
    m_layers = (most_layers + draws - 1) / draws;  // all draws as full as the last
    m_radiance = gl::Texture(GL_RGBA32F, side, side, m_layers);
    m_depth = gl::Texture(GL_DEPTH_COMPONENT32F, side, side, m_layers);
    m_mean = gl::Texture(GL_RGBA32F, side, side);
    m_pixels = gl::Texture(GL_RGBA32F, m_cell, m_cell);
    m_radiance_target = gl::Framebuffer(&m_radiance, &m_depth);
    m_pixels_target = gl::Framebuffer(&m_pixels, nullptr);
    if (!filter.factor.empty()) {
        m_table = gl::Buffer::of(filter.factor);
        m_gather = gather_program(filter);
        return;
    }
    if (!filter.taps.empty()) {
        m_table = gl::Buffer::of(filter.taps);
        m_gather = screen_program("pixel filter", "resolve/taps.frag", lattice_defines());
        return;
    }
    m_table = gl::Buffer::of(std::vector<float>(filter.weights.begin(), filter.weights.end()));
    m_rows = gl::Texture(GL_RGBA32F, m_cell, side);
    m_rows_target = gl::Framebuffer(&m_rows, nullptr);
    m_filter_x = filter_program(filter, "ivec2(1, 0)");
    m_filter_y = filter_program(filter, "ivec2(0, 1)");
}

gl::Defines RasterTarget::lattice_defines() const {
    return {{"LATTICE", std::to_string(m_lattice.side)},
            {"ROTATED", m_lattice.rotated ? "1" : "0"},
            {"ORIGIN", vector_source(m_origin)}};
}

std::vector<RasterCell> RasterTarget::cells(const Rect& pixels) const {
    std::vector<RasterCell> cells;
    for (int y = floor_to(pixels.y0, m_cell); y < pixels.y1; y += m_cell)
        for (int x = floor_to(pixels.x0, m_cell); x < pixels.x1; x += m_cell) {
            RasterCell cell;
            cell.corner = {x - m_margin, y - m_margin};
            cell.pixels = pixels.intersect({x, y, x + m_cell, y + m_cell});
            cell.samples = {cell.pixels.x0 - m_margin, cell.pixels.y0 - m_margin,
                            cell.pixels.x1 + m_margin, cell.pixels.y1 + m_margin};
            cell.texels = texels_of(cell, cell.samples);
            if (!cell.pixels.empty()) cells.push_back(cell);
        }
    return cells;
}

void RasterTarget::bind(const gl::Framebuffer& framebuffer, const RasterCell& cell) const {
    const int side = texel_size();
    framebuffer.bind();
    glViewport(0, 0, side, side);
    glEnable(GL_SCISSOR_TEST);
    glScissor(cell.texels.x, cell.texels.y, cell.texels.width, cell.texels.height);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthRangef(0.0f, 1.0f);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
}

void RasterTarget::begin_radiance(const RasterCell& cell, float farthest) {
    constexpr float kNothing[4] = {0.0f, 0.0f, 0.0f, -1.0f};
    if (!std::exchange(m_empty, false))
        m_radiance.clear({0, 0, m_texel_size, m_texel_size}, kNothing);
    bind(m_radiance_target, cell);
    glClearNamedFramebufferfv(m_radiance_target.name(), GL_DEPTH, 0, &farthest);
}

void RasterTarget::begin_surfaces(const RasterCell& cell, float farthest) {
    if (m_surfaces.name() == 0) {
        m_surfaces = gl::Texture(GL_R32UI, m_depth.width(), m_depth.height(), m_layers);
        m_surfaces_target = gl::Framebuffer(&m_surfaces, &m_depth);
    }
    bind(m_surfaces_target, cell);
    const GLuint none = 0;
    glClearNamedFramebufferuiv(m_surfaces_target.name(), GL_COLOR, 0, &none);
    glClearNamedFramebufferfv(m_surfaces_target.name(), GL_DEPTH, 0, &farthest);
}

void RasterTarget::dispatch(const RasterCell& cell, int layers) const {
    const gl::TexelRect& t = cell.texels;
    const auto groups = [](int texels) {
        return static_cast<GLuint>((texels + RASTER_GROUP - 1) / RASTER_GROUP);
    };
    glUniform4i(RASTER_TEXELS, t.x, t.y, t.width, t.height);
    glDispatchCompute(groups(t.width), groups(t.height), static_cast<GLuint>(layers));
}

void RasterTarget::fill(const gl::Framebuffer& target, const gl::Texture& texture,
                        const gl::TexelRect& part, Vec2i origin) const {
    glDisable(GL_DEPTH_TEST);
    m_no_attributes.bind();
    target.bind();
    glUniform2i(FILTER_ORIGIN, origin.x, origin.y);
    glViewport(0, 0, texture.width(), texture.height());
    glScissor(part.x, part.y, part.width, part.height);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

gl::Readback RasterTarget::resolve(const RasterCell& cell, const RasterSamples* samples) const {
    const gl::TexelRect own = own_pixels(cell);
    const int margin_texels = m_margin * m_lattice.side;
    m_mean.bind(FILTER_SOURCE);
    m_table.bind_storage(FILTER_TABLE);
    if (samples != nullptr || m_lattice.rotated) {
        m_gather.use();
        if (samples != nullptr) {
            samples->bind();
            glUniform1f(FILTER_RADIUS, m_radius);
        }
        fill(m_pixels_target, m_pixels, own, {m_margin, m_margin});
    } else {
        m_filter_x.use();
        fill(m_rows_target, m_rows, {own.x, cell.texels.y, own.width, cell.texels.height},
             {margin_texels, 0});
        m_filter_y.use();
        m_rows.bind(FILTER_SOURCE);
        fill(m_pixels_target, m_pixels, own, {0, margin_texels});
    }
    gl::check("filtering a cell");
    return gl::Readback(m_pixels, own);
}

std::vector<float> RasterTarget::center_depths(const RasterCell& cell,
                                               const RasterSamples* samples) {
    if (m_center.name() == 0) {
        // Of four on a square lattice, the first.
        const Vec2i center = m_lattice.rotated ? m_lattice.texel(m_lattice.center_cell())
                                               : Vec2i((m_lattice.side - 1) / 2);
        gl::Defines defines = lattice_defines();
        defines.emplace_back("AT_SAMPLE", samples != nullptr ? "1" : "0");
        defines.emplace_back("CENTER", vector_source(center));
        m_center_depths = gl::Texture(GL_R32F, m_cell, m_cell);
        m_center_depths_target = gl::Framebuffer(&m_center_depths, nullptr);
        m_center = screen_program("depth of pixels", "resolve/depth.frag", defines);
    }
    const gl::TexelRect own = own_pixels(cell);
    m_center.use();
    if (samples != nullptr) samples->bind();
    m_surfaces.bind(0);
    m_depth.bind(1);
    fill(m_center_depths_target, m_center_depths, own, {m_margin, m_margin});
    gl::check("depth of a cell");
    return m_center_depths.read<float>(own, GL_RED, 1);
}

gl::TexelRect RasterTarget::own_pixels(const RasterCell& cell) const {
    return {cell.pixels.x0 - cell.corner.x - m_margin, cell.pixels.y0 - cell.corner.y - m_margin,
            cell.pixels.width(), cell.pixels.height()};
}

gl::TexelRect RasterTarget::texels_of(const RasterCell& cell, const Rect& pixels) const {
    const Vec2i corner = cell.corner;
    const Rect texels = m_lattice.texels_of(
        {pixels.x0 - corner.x, pixels.y0 - corner.y, pixels.x1 - corner.x, pixels.y1 - corner.y});
    return {texels.x0 + m_origin.x, texels.y0 + m_origin.y, texels.width(), texels.height()};
}

template <class T>
std::vector<T> RasterTarget::by_sample(const RasterCell& cell, const std::vector<T>& texels) const {
    const gl::TexelRect box = texels_of(cell, cell.pixels);
    std::vector<T> samples;
    for (int y = cell.pixels.y0; y < cell.pixels.y1; ++y)
        for (int x = cell.pixels.x0; x < cell.pixels.x1; ++x) {
            const Vec2i first = m_lattice.first_texel(Vec2i(x, y) - cell.corner) + m_origin;
            for (int s = 0; s < m_lattice.cells(); ++s) {
                const Vec2i at = first + m_lattice.texel(s) - Vec2i(box.x, box.y);
                samples.push_back(texels[static_cast<std::size_t>(at.y) * box.width + at.x]);
            }
        }
    return samples;
}

std::vector<std::uint32_t> RasterTarget::read_surfaces(const RasterCell& cell) const {
    return by_sample(
        cell, m_surfaces.read<std::uint32_t>(texels_of(cell, cell.pixels), GL_RED_INTEGER, 1));
}

std::vector<float> RasterTarget::read_depth(const RasterCell& cell) const {
    return by_sample(cell,
                     m_depth.read<float>(texels_of(cell, cell.pixels), GL_DEPTH_COMPONENT, 1));
}

}  // namespace granita
